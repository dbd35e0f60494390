"""The books that a controller keeps of its energy, kept a second time beside it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from pliant.controllers.energy_ledger import TASK_SUMS
from pliant.controllers.joint_limits import JointLimitsState
from pliant.controllers.step_limit import StepLimitState
from pliant.signals import Command, Estimate

ERROR = 1e-6  # J


class Books:
    """Looks at every tick that a controller computes. What it was fed shows here: a reading that is not sound, or one
    that is missed, moves its books away from those that are kept of the sound ones.

    - A stack's: supplied + tuning = delivered + dissipated + stored − stored at the start; the sums of its tasks are
      its totals; what is dissipated is the sum of all storage margins.
    - The springs' at joint limits: −Στ·Δq since each joint came near its limit.
    - The torque step's: Σ held back·Δq.
    """

    def __init__(self) -> None:
        self.wrong: list[str] = []
        self.kept: set[str] = set()
        """names of the books that were there, and not empty"""
        self._start: float | None = None
        self._springs: tuple[Any, Any, Any] | None = None  # q, torque sent, account
        self._steps: tuple[Any, Any, float] | None = None  # q, held back, energy

    def __call__(self, estimate: Estimate, command: Command, state: Any) -> None:
        told = command.diagnostics
        if "energy/stored" in told:
            self._look("stack", list(self._of_stack(told)))
        for inside in _chain(state):
            if isinstance(inside, JointLimitsState):
                self._look("joint limits", self._of_springs(estimate, inside, told), bool(inside.account.any()))
            if isinstance(inside, StepLimitState):
                self._look("torque step", self._of_steps(estimate, inside, told), inside.energy != 0.0)

    def _look(self, name: str, errors: list[float], used: bool = True) -> None:
        if used:
            self.kept.add(name)
        self.wrong += [f"{name}: {error:.3g} J" for error in errors if not abs(error) < ERROR]

    def _of_stack(self, told: Any) -> Iterator[float]:
        total = {
            name: float(told[f"energy/{name}"]) for name in ("supplied", "tuning", "delivered", "dissipated", "stored")
        }
        balance = total["supplied"] + total["tuning"] - total["delivered"] - total["dissipated"] - total["stored"]
        self._start = balance if self._start is None else self._start
        yield balance - self._start
        for name in TASK_SUMS:
            yield (
                sum(float(told[key]) for key in told if key.endswith(f"/{name}")) - total[name.removeprefix("energy_")]
            )
        margins = sum(float(np.sum(told[key])) for key in told if key.endswith("/storage_margin"))
        yield margins - total["dissipated"]

    def _of_springs(self, estimate: Estimate, state: JointLimitsState, told: Any) -> list[float]:
        if self._springs is None:
            account = state.account
        else:
            q, sent, before = self._springs
            near = state.account != 0.0  # a joint away from its limits begins anew
            account = np.where(near, before - sent * (estimate.q - q), 0.0)
        self._springs = estimate.q, told["joint_limits/torque"], account
        return [*(account - state.account), float(told["energy/joint_limits"]) - float(np.sum(account))]

    def _of_steps(self, estimate: Estimate, state: StepLimitState, told: Any) -> list[float]:
        energy = 0.0
        if self._steps is not None:
            q, held_back, before = self._steps
            energy = before + float(held_back @ (estimate.q - q))
        self._steps = estimate.q, state.held_back, energy
        return [float(told["energy/step_limit"]) - energy]


def _chain(state: Any) -> Iterator[Any]:
    """A layered controller's states, from the outside in."""
    while state is not None:
        yield state
        state = getattr(state, "inner", None)
