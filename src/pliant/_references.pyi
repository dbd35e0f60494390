"""Typed face of functions of time (cpp/references)."""

from collections.abc import Sequence

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
