"""Typed face of the compiled look at signals (cpp/guard).

True: the signal is sound beyond doubt, made of NumPy's own arrays of float64. False: `pliant.guard.sound` has to look.
"""

from collections.abc import Mapping, Sequence
from typing import Any

from pliant._loop import Part
from pliant.spatial import Array

def is_reading(reading: Any, n: int, frames: tuple[str, ...]) -> bool:
    """A measurement for n joints and force sensors at these frames."""

def is_estimate(estimate: Any, n: int) -> bool:
    """An estimate for n joints, without surfaces."""

def is_reference(reference: Any, n: int) -> bool:
    """A reference for n joints."""

def is_command(command: Any, n: int, bound: Array | None) -> bool:
    """A command for n joints of which no torque is larger than its bound (n,), N·m, if there is one."""

class StepLimit:
    """The bound on torque steps of n joints. Sizes that are wrong raise ValueError."""

    def __init__(self, step_max: Sequence[float]) -> None:
        """Args: step_max: (n,) N·m, may be infinite."""

    @property
    def memory_size(self) -> int:
        """Of the memory: joint positions (n), rad; torque sent (n) and torque held back (n), N·m; J that was withheld
        from the robot."""

    def step(
        self,
        torque: Array,
        clamped: Array,
        q: Array,
        diagnostics: Mapping[str, Any],
        channel: str,
        channels: Array | None,
        memory: Array,
        out: Array,
    ) -> float | None:
        """One tick; changes `memory` and fills `out`.

        Args:
            torque, clamped: (n,) N·m that are asked for, and were clamped before.
            q: (n,) rad.
            diagnostics: of the controller, read where a part of the torque is held back.
            channel: of the diagnostics, J that may be spent; where it is missing nothing gives way.
            channels: (k,) the numbers of the diagnostics, where they lie in one array.
            memory: state.
            out: (2 n,) torque and clamped torque, N·m; with `channels` (2 n + k + 2,): these, J that was withheld, and
                by how much the bound is exceeded.

        Returns:
            By how much the bound is exceeded, as a share of it; None: the torque is as it was asked for.
        """

class StepLimitPart(Part):
    """The bound as a part of a compiled loop, round a controller that is one, too."""

    def __init__(self, limit: StepLimit, inner: Part, q: int, command: Sequence[int], begin: int) -> None:
        """Args: the bound; the controller inside; where a row has the estimated joints (n); where it has the inner
        command's torque, clamped torque, channels and the J that may be spent (-1: nobody says), with the number of
        channels before the last of these; where its own numbers begin, in the order of `StepLimit.step`."""
