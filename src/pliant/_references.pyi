"""Typed face of functions of time (cpp/references)."""

from collections.abc import Callable, Sequence

from pliant.spatial import Array

class Spline:
    """A cubic spline through samples, with its first two derivatives, as coefficients of each piece."""

    def __init__(
        self, times: Sequence[float], step: float, pieces: Array, first: Sequence[float], last: Sequence[float]
    ) -> None:
        """
        Args:
            times: (m,) s, increasing.
            step: s between them; 0: they are not equally spaced.
            pieces: (m - 1, 4, width) coefficients of each column by ascending power; read where they lie.
            first, last: (width,) what holds before and after the samples.

        Raises:
            ValueError: parts that do not fit together.
        """

    def at(self, time: float, out: Array) -> None:
        """Writes every column (width,) at a time in s. Raises ValueError for a row of another width, or no number."""

    def rows(self, times: Array, out: Array) -> None:
        """Writes every column at times (k,) in s into `out` (k, width). Errors as of `at`."""

class RowsAhead:
    """Rows of a function of time, worked out once for each tick of a clock, 128 ticks in one go. A cache: what it gives
    depends on the time asked for, not on what was asked before."""

    def __init__(self, rows: Callable[[Array], Array], rounding: float) -> None:
        """
        Args:
            rows: times (m,) s, zero or more, to rows (m, w) side by side; each row depends on its own time only.
            rounding: s by which an instant may miss a tick of the clock.
        """

    def row(self, time: float, period: float) -> Array:
        """Row (w,) at a time, now.

        Args:
            time: s.
            period: s from one tick of the clock to the next; 0: it is not regular.

        Raises:
            ValueError: there is not a row for each time, or they have another width than before.
        """

    def task(
        self, time: float, period: float, offset: Array | None, height: Sequence[float]
    ) -> tuple[Array, Array, Array, Array, Array, Array, Array | None]:
        """`parts_of` the row at a time. Args: as there and of `row`. Raises ValueError as these do."""

    def fill(
        self,
        table: Array,
        begin: int,
        end: int,
        times: Array,
        start: float,
        period: float,
        offset: Array | None,
        heights: Sequence[float],
    ) -> None:
        """Writes the rows of equally spaced times from now on, moved.

        Args:
            table: (N+1, w), w ≥ 57, of which the rows `begin` to `end` are written.
            begin, end: numbers of the first of these rows, and of the one after the last.
            times: (N+1,) s of the loop's clock.
            start: s at which the function's own clock is zero.
            period: s from one tick of the loop's clock to the next; 0: it is not regular.
            offset: (3,) m, displacement of all of them; None: none.
            heights: m, m/s and m/s² along the normal, once for all rows or for each in turn; empty: none.

        Raises:
            ValueError: parts that do not fit together.
        """
    def preview(
        self,
        time: float,
        nodes: Array,
        start: float,
        period: float,
        offset: Array | None,
        heights: Sequence[float],
        turning: bool,
        width: int,
    ) -> tuple[Array, Array, Array, Array, Array, Array | None, Array | None]:
        """`columns_of` a preview of which all nodes are within this function's phase.

        Args:
            time: s of the loop's clock.
            nodes: (N+1,) s after it, equally spaced.
            start, period, offset, heights: as of `fill`.
            turning: as of `columns_of`.
            width: numbers of a row.

        Raises:
            ValueError: parts that do not fit together.
        """

def parts_of(
    row: Array, offset: Array | None, height: Sequence[float]
) -> tuple[Array, Array, Array, Array, Array, Array, Array | None]:
    """Position (3,), rotation (3, 3), twist (6,) and its rate (6,), wrench (6,), task axes (3, 3) and posture (n,) of a
    row (57 + n,), moved; read-only. None in place of a posture without numbers.

    Args:
        row: as `preview_rows.sampled` makes it.
        offset: (3,) m, displacement; None: none.
        height: m, m/s and m/s² along the normal of the axes; empty: none.

    Raises:
        ValueError: numbers of another shape.
    """

def columns_of(
    times: Array, table: Array, turning: bool
) -> tuple[Array, Array, Array, Array, Array, Array | None, Array | None]:
    """The times as given, position (m, 3), rotation (m, 3, 3), twist (m, 6), wrench (m, 6), posture (m, n), task axes
    (m, 3, 3) of the rows of a table (m, 57 + n), views of it; None in place of a posture without numbers, and of axes
    unless they are `turning`. Raises ValueError for a table of another shape."""

class FrameCore:
    """Haptic exploration of the axes of one frame, or of the one direction along its contact normal."""

    def __init__(self) -> None: ...
    @property
    def offsets(self) -> list[float]:
        """Δx (6,), m and rad."""

    @property
    def clamped(self) -> list[float]:
        """(6,) parts of the desired force that exceed F_max, N and N·m."""

    def rule(
        self,
        linear: Sequence[float],
        angular: Sequence[float],
        asked: Sequence[bool],
        printed: bool,
        normal: bool,
        resolution: float,
        turn: Sequence[float],
    ) -> None:
        """Other parameters.

        Args:
            linear, angular: (16,) each, `AxisRules.numbers`.
            asked: (6,) whether F_d = 0 is a request, of each axis.
            printed: whether the printed algorithm moves the target.
            normal: whether it moves along the estimated contact normal only.
            resolution: σ of the printed algorithm.
            turn: least force, N, time constant, s, rate, rad/s, and cone, rad, of the estimated normal.

        Raises:
            ValueError: another number of rules.
        """

    def limit(self, limits: Sequence[Sequence[float]]) -> None:
        """Other bounds of 3 or 6 axes, to which the offsets keep from now on. Args: limits: stiffness, N/m, largest
        force, N, and bound of the offset, m, of each. Raises ValueError for another number of axes."""

    def begin(self, offsets: Sequence[float]) -> None:
        """Other axes, in which the offsets (6,) are these, m and rad: they begin anew."""

    def step(
        self, desired: Array, measured: Array | None, place: Array, velocity: Array, time: float, period: float
    ) -> tuple[Array, Array, bool, bool]:
        """Moves the offsets of k axes.

        Args:
            desired: F_d (6,), N and N·m.
            measured: F (6,); None: it is zero. Not finite: there is no usable signal, and offsets are held.
            place: x_d (3,) without the offset, m.
            velocity: of x_d (3,) or longer, m/s.
            time: s.
            period: s since the last tick.

        Returns:
            Channels (6 k,): Δx, phase, stiffness, reachable, unreachable and clamped force, each (k,); x_d + Δx (3,) m;
            whether Δx turns the frame; whether a force was clamped.

        Raises:
            ValueError: too few numbers, or no bounds yet.
        """

def pressed(wrench: Array, place: Array) -> int:
    """1 where a wrench (6,), N and N·m, is not zero, else 0; −1: it or the place (3,) m is not finite. Raises
    ValueError for too few numbers."""

def superposed(
    base: tuple[float, ...],
    pieces: tuple[tuple[float, float, tuple[float, ...], tuple[float, ...]], ...],
    time: float,
    width: int,
) -> tuple[Array, Array, Array]:
    """Position (k,), velocity and acceleration (width,) of half cosines on top of a base; beyond the k axes these are
    zero.

    Args:
        base: (k,) m or rad.
        pieces: start, s, duration, s, way (k,) and target of each.
        time: s.
        width: k or more.

    Raises:
        ValueError: ways of another size than the base, or a width that does not hold it.
    """

def turning(
    base: tuple[float, ...],
    pieces: tuple[tuple[float, float, tuple[float, ...], tuple[float, ...]], ...],
    time: float,
    step: float,
) -> tuple[Array, Array]:
    """Angular velocity (3,) rad/s and acceleration (3,) rad/s², world axes, of a rotation vector that is planned like
    `superposed`: ω = J_l(r) ṙ (Chirikjian, Stochastic Models, vol. 2, eq. 10.86).

    Args:
        base: (3,) rad.
        pieces: as of `superposed`.
        time: s.
        step: s, half of the time over which the acceleration is a difference of velocities.

    Raises:
        ValueError: another number of axes than three.
    """
