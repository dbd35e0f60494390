"""The predictive controllers by name."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pliant.entries import ControllerEntry
from pliant.errors import ConfigError
from pliant.mpc.config import ClassicalMpc, ForceFeedbackMpc, MpcConfig, OffsetFreeMpc, TorqueFeedbackMpc
from pliant.mpc.controller import MpcController
from pliant.mpc.costs import Term
from pliant.robot import Robot


def build_mpc(robot: Robot, config: MpcConfig, period: float) -> MpcController:
    """A predictive controller from its configuration, for a control period in s.

    Raises:
        ConfigError: it would have to solve more often than the loop runs.
    """
    if config.period < period - 1e-9:
        raise ConfigError(
            f"period (time from solve to solve) must be at least the control period {period:g} s, got"
            f" {config.period:g} s"
        )
    return MpcController(robot, config, period)


def advise_mpc(robot: Robot, config: MpcConfig, period: float) -> tuple[str, ...]:
    """What makes the solver converge badly: force costs along a surface on which the predicted contact slides."""
    if config.contact.friction is None:
        return ()
    phases = [phase.over(config.costs) for phase in config.phases.values() if phase.contact]
    terms = {"force": [costs.force for costs in phases], "force_rate": [costs.force_rate for costs in phases]}
    counted = [name for name, own in terms.items() if any(_counts_tangents(term) for term in own)]
    if not counted:
        return ()
    return (
        f"contact.friction with costs on the tangential force ({' and '.join(counted)}): many solves may end before"
        " they converge; set the activation of both terms to [0, 0, 1]",
    )


def _counts_tangents(term: Term) -> bool:
    given = term.activation[:2]
    return (term.weight > 0.0 or bool(term.terminal)) and any(value > 0.0 for value in given)


CONTROLLERS: Mapping[str, ControllerEntry[Any]] = {
    entry.name: entry
    for entry in (
        ControllerEntry(
            "force-feedback-mpc",
            "predictive, visco-elastic contact, the measured force is part of the state (Kleff et al. 2024)",
            ForceFeedbackMpc(),
            build_mpc,
            advise_mpc,
        ),
        ControllerEntry(
            "offset-free-mpc",
            "force feedback with disturbance observer, prediction over delays and force integral",
            OffsetFreeMpc(),
            build_mpc,
            advise_mpc,
        ),
        ControllerEntry(
            "torque-feedback-mpc",
            "predictive, rigid contact, the measured joint torque is part of the state",
            TorqueFeedbackMpc(),
            build_mpc,
        ),
        ControllerEntry(
            "classical-mpc",
            "predictive, rigid contact, feedback of position and velocity only",
            ClassicalMpc(),
            build_mpc,
        ),
    )
}
"""name → entry"""
