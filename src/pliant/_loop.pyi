"""Typed face of the compiled loop (cpp/loop): blocks of ticks whose parts are all compiled."""

from collections.abc import Sequence

from pliant.spatial import Array

class Part:
    """An estimator or a controller: it reads and writes numbers of a tick's row, and has a memory of its own."""

    @property
    def memory_size(self) -> int:
        """Numbers that it remembers."""

class World:
    """A simulated robot: from the command of a tick to the measurement in the next row."""

class Block:
    """Ticks one after the other, until one is not as usual. Spans and places are in numbers of a row.

    Raises ValueError: a span beyond the row.
    """

    def __init__(
        self,
        width: int,
        estimator: Part,
        controller: Part,
        world: World,
        measured: Sequence[tuple[int, int]],
        estimated: Sequence[tuple[int, int]],
        made: Sequence[tuple[int, int]],
        drawn: Sequence[tuple[int, int]],
        unknown: Sequence[int],
        torque: int,
        most: Sequence[float],
    ) -> None:
        """
        Args:
            width: numbers of a row.
            estimator, controller, world: the parts.
            measured: (begin, size) of what must be finite before the estimator is stepped.
            estimated: of what must be finite before the controller is.
            made: of what must be finite after the controller was.
            drawn: of what noise makes different from the row before.
            unknown: places that hold no number after the estimator was stepped.
            torque: where the command's torque begins.
            most: (n,) N·m that it may be; empty: there is no limit.
        """

    @property
    def memory_size(self) -> int:
        """Numbers that estimator and controller remember, in this order."""

    def run(self, rows: Array, ticks: int, memory: Array, wall: Array) -> tuple[int, bool]:
        """Runs up to so many ticks, without holding Python's lock.

        Args:
            rows: (ticks + 1 or more, width) the first measurement and all references; filled.
            ticks: at most.
            memory: state of estimator and controller.
            wall: (ticks or more, 2) filled with s of wall time up to the controller, and of it.

        Returns:
            How many ticks are complete, and whether the robot stopped in the period of the last one. The row after them
            holds the next measurement; the tick that Python has to look at is not begun.

        Raises:
            ValueError: arrays of another size.
        """
