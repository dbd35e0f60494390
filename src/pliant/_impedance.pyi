"""Compiled core of the stack of fractal impedance tasks. `pliant.controllers.stack` is its face; use that."""

from collections.abc import Sequence
from typing import Any

from numpy import float64
from numpy.typing import NDArray

from pliant._loop import Part

ENERGIES: tuple[str, ...]
"""names of the totals in `out`, after torque and clamped torque (n) each"""
AXIS_ROWS: tuple[str, ...]
"""names of what a task reports of each of its axes, after its wrench (6)"""
TASK_SUMS: tuple[str, ...]
"""names of what a task reports once, after the rows of its axes"""
ACCOUNT: tuple[str, ...]
"""names of the numbers in `account`"""

class Stack:
    """Phase logic, force laws, torque and energy ledger of several tasks. Holds no state between two steps.

    Wrong sizes and names raise ValueError.
    """

    def __init__(
        self,
        law: str,
        period: float,
        rate_gain: float,
        noise_gain: float,
        hold_limit: float,
        blend_step: float,
        account: NDArray[float64] | None,
        torque_limit: NDArray[float64],
        tasks: list[tuple[int, str, float, float, list[bool]]],
    ) -> None:
        """
        Args:
            law: name of a force law.
            period: s.
            rate_gain: share of a new difference in the filtered rate.
            noise_gain: share of a new sample in the noise variance.
            hold_limit: s.
            blend_step: share of the force's step at the end of a convergence that one period takes away.
            account: (14,) `AccountSettings.numbers`, or None: no passivity account, and no bound on moments.
            torque_limit: (n,) N·m, may be infinite.
            tasks: (axes, profile, rate floor in m/s, rate floor in rad/s, which joints move the frame) each.
        """

    @property
    def state_size(self) -> int: ...
    @property
    def output_size(self) -> int: ...
    @property
    def kept_back(self) -> int:
        """Where in the memory the torque (n) stands that was asked for and not sent."""
    def step(
        self,
        memory: NDArray[float64],
        out: NDArray[float64],
        q: NDArray[float64],
        J: NDArray[float64],
        actual: tuple[NDArray[float64] | None, ...],
        desired: tuple[NDArray[float64] | None, ...],
        bias: NDArray[float64] | None,
        retune: tuple[tuple[int, NDArray[float64]], ...] | None,
        axes: tuple[NDArray[float64] | None, ...] | None = None,
    ) -> int:
        """One tick; changes `memory` (state_size) and fills `out` (output_size).

        Args:
            memory: state, zeros before the first step.
            out: torque, clamped torque, then the channels of `channel_table`.
            q: (n,) rad.
            J: (6, n) column-major, joint Jacobian at the world's origin, linear part first.
            actual: position (3,), R_world_frame (3, 3) of each task in turn.
            desired: the same of the reference; a rotation may be None.
            bias: (n,) N·m added to the torque.
            retune: (task, stiffness ‖ force_max ‖ range ‖ linear_range) for each tuning that changes now.
            axes: R_world_axes (3, 3) of each task, in which its axes are separate; None: the world's. Where they change
                the axes start anew, and what is stored more is booked as a change of the tuning.

        Returns:
            0, or what is not finite (then nothing was changed): 1 for q, 100 + i for frame i, 200 + i for its
            reference.
        """

    def step_on(
        self,
        arm: Arm,
        memory: NDArray[float64],
        out: NDArray[float64],
        estimate: Any,
        targets: tuple[Any, ...],
        seen: tuple[tuple[object, object, bool | None], ...] | None,
        bias: NDArray[float64] | None,
        retune: tuple[tuple[int, NDArray[float64]], ...] | None,
    ) -> int:
        """One tick on a robot; `memory`, `out`, `bias`, `retune` and the answer as for `step`.

        Args:
            arm: the robot with the frames of the tasks.
            estimate: its q says where the frames are.
            targets: a `TaskReference` for each task in turn; position, rotation and axes are read.
            seen: of each task's last reference: tuning, modes, and whether it had no rotation. None: is not compared.

        Returns:
            As `step`; -1 where the references are not of the arm's frames in turn, or not as `seen` says: nothing was
            changed then.

        Raises TypeError where something is no array.
        """

class Arm:
    """The frames of a stack's tasks on a robot; holds scratch space and no state."""

    def __init__(self, robot: Any, frames: Sequence[str]) -> None:
        """Args: robot: a `pliant._estimation.Tree`; frames: one for each task.

        Raises ValueError for a frame that it does not have.
        """

def drive_axis(
    law: str,
    period: float,
    rate_gain: float,
    noise_gain: float,
    hold_limit: float,
    blend_step: float,
    account: NDArray[float64] | None,
    shape: str,
    tuning: NDArray[float64],
    rate_floor: float,
    rotates: bool,
    errors: NDArray[float64],
    forces: NDArray[float64],
    balances: NDArray[float64],
) -> None:
    """Drives one axis, whose target rests, along many histories: for searches.

    Args:
        law, period, rate_gain, noise_gain, hold_limit, blend_step, account: as for `Stack`.
        shape: name of a profile.
        tuning: stiffness, force_max, range, linear_range.
        rate_floor: m/s or rad/s.
        rotates: whether it is a rotation.
        errors: (steps, trials) m or rad.
        forces: (steps, trials), filled: N or N·m, held until the next step.
        balances: (steps, trials), filled: of the account, J.
    """

class StackPart(Part):
    """A stack on an arm as a part of a compiled loop, with tunings and axes that do not change."""

    def __init__(
        self, stack: Stack, arm: Arm, q: int, targets: Sequence[tuple[int, int, Sequence[float]]], begin: int
    ) -> None:
        """Args: the stack and its arm, which are copied; where a row has the estimated joints (n); of each task, where
        its position and its rotation stand, or -1 and the rotation (9,) that does not change, or nothing; where its own
        numbers begin, in the order of `Stack.step`."""
