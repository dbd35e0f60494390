"""Harmonic superposition: smooth motion to targets that may change at any time.

Every target adds one half cosine: x_d = x_0 + Σ_k Δ_k ½(1 − cos π u_k), u_k = clip((t − t_k)/T_k, 0, 1), with Δ_k the
    displacement from the previous target to this one. No piece ends before an earlier one, so that at every instant the
        earlier pieces are more complete than the later ones, and x_d is a convex combination of x_0 and the targets so
        far: it cannot
leave their hull. At rest it is exactly on the last target. All axes of a piece share one clock, so a single motion is
a straight line.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from pliant._references import superposed
from pliant.axis_modes import AxisModes
from pliant.errors import ConfigError
from pliant.spatial import Array


@dataclass(frozen=True)
class MotionLimits:
    """Bounds on the length of the velocity and of the acceleration, the sum of all pieces included."""

    speed: float
    """m/s or rad/s"""
    acceleration: float
    """m/s² or rad/s²"""

    def __post_init__(self) -> None:
        for name in ("speed", "acceleration"):
            value = getattr(self, name)
            if not (math.isfinite(value) and value > 0.0):
                raise ConfigError(f"the {name} limit of a planner must be above zero, got {value}")

    def duration(self, distance: float) -> float:
        """Least time in s for a half cosine over a distance in m or rad."""
        # peaks of a half cosine: speed π d/(2T), acceleration π² d/(2T²)
        return max(0.5 * math.pi * distance / self.speed, math.pi * math.sqrt(0.5 * distance / self.acceleration))

    def bounded(self, modes: AxisModes | None, way: Array) -> MotionLimits:
        """Limits of a motion along a displacement (3,) m within the bounds of modes along force axes."""
        if modes is None or math.isinf(modes.speed):
            return self
        along = float(np.linalg.norm((modes.rotation.T @ way)[list(modes.having("force")[:3])]))
        if along == 0.0:
            return self
        return replace(self, speed=min(self.speed, modes.speed * float(np.linalg.norm(way)) / along))


class HalfCosine(NamedTuple):
    """One half cosine."""

    start: float
    """t_k, s"""
    duration: float
    """T_k, s"""
    way: tuple[float, ...]
    """Δ_k (k,), m or rad"""
    target: tuple[float, ...]
    """(k,) where it leads"""


class PlannedMotion(NamedTuple):
    """The planner at one instant; each tuple (k,)."""

    position: tuple[float, ...]
    velocity: tuple[float, ...]
    acceleration: tuple[float, ...]


@dataclass(frozen=True, slots=True)
class Superposition:
    """Active pieces on top of a base point. Immutable: retargeting returns another plan."""

    base: tuple[float, ...]
    """(k,) where all finished pieces led"""
    pieces: tuple[HalfCosine, ...] = ()
    """in the order of their starts, which is the order of their ends"""

    @property
    def target(self) -> tuple[float, ...]:
        """(k,) where it will come to rest."""
        return self.pieces[-1].target if self.pieces else self.base

    def end(self) -> float:
        """s at which it comes to rest; minus infinity if it is at rest."""
        return self.pieces[-1].start + self.pieces[-1].duration if self.pieces else -math.inf

    def folded(self, time: float) -> Superposition:
        """The same motion from `time` on, finished pieces dropped."""
        pieces = self.pieces
        if not pieces or time < pieces[0].start + pieces[0].duration:
            return self
        done = 0
        while done < len(pieces) and time >= pieces[done].start + pieces[done].duration:
            done += 1
        return Superposition(pieces[done - 1].target, pieces[done:])

    def at(self, time: float) -> PlannedMotion:
        """Position, velocity and acceleration at a time in s."""
        found = superposed(self.base, self.pieces, time, len(self.base))
        return PlannedMotion(*[tuple(part.tolist()) for part in found])

    def retargeted(
        self, time: float, target: tuple[float, ...], limits: MotionLimits, least: float = 0.0
    ) -> Superposition:
        """The plan with a new target.

        A piece that has not begun yet is replaced. The new one starts now and lasts as long as its own limits and the
        order of the ends require; where the sum with the pieces under way would break a limit, it is stretched or
        starts later, whichever ends first. Starting when the last one ends is always possible, so that a plan is always
        found.

        Args:
            time: now, s.
            target: (k,) m or rad.
            limits: of the summed motion.
            least: s that the new piece shall last at least (to go along with another group of axes).
        """
        begun = tuple(piece for piece in self.pieces if piece.start < time)
        under_way = Superposition(self.base, begun).folded(time)
        way = tuple(b - a for a, b in zip(under_way.target, target, strict=True))
        distance = math.hypot(*way)
        if distance == 0.0 and under_way.target == target:
            return under_way
        shortest = max(limits.duration(distance), least, 1e-6)
        start, duration = _earliest(under_way, time, way, shortest, limits)
        return Superposition(under_way.base, (*under_way.pieces, HalfCosine(start, duration, way, target)))


_STRETCHES = np.array([1.0, 1.25, 1.6, 2.2, 3.0])
_DELAYS = 8
_GRID = 65
_SLACK = 1.0 + 1e-9


def _earliest(
    plan: Superposition, time: float, way: tuple[float, ...], shortest: float, limits: MotionLimits
) -> tuple[float, float]:
    """Start and duration, s, of a new piece: the pair that ends first among those that keep the limits."""
    if not plan.pieces:
        return time, shortest
    rest = plan.end()
    delays = np.linspace(0.0, 1.0, _DELAYS, endpoint=False) * (rest - time)
    starts = np.repeat(time + delays, _STRETCHES.size)
    durations = np.maximum(np.tile(_STRETCHES * shortest, _DELAYS), rest - starts)
    ends = starts + durations
    keeps = _keeps_limits(plan, time, rest, starts, durations, np.array(way), limits) & (
        ends < rest + (1.0 - 1e-9) * shortest
    )
    if not keeps.any():
        return rest, shortest  # one after the other: each piece is within the limits
    # Of pieces that end together the one that starts first: a tie must not depend on rounding.
    best = int(np.argmin(np.where(keeps, ends + 1e-3 * (starts - time), np.inf)))
    return float(starts[best]), float(durations[best])


def _keeps_limits(
    plan: Superposition,
    time: float,
    rest: float,
    starts: Array,
    durations: Array,
    way: Array,
    limits: MotionLimits,
) -> npt.NDArray[np.bool_]:
    """Which candidates (c,) keep the limits of summed speed and acceleration while older pieces are under way, bool."""
    times = np.linspace(time, rest, _GRID)
    ways = np.array([piece.way for piece in plan.pieces])  # (p, k)
    old_starts = np.array([piece.start for piece in plan.pieces])
    old_durations = np.array([piece.duration for piece in plan.pieces])
    old = _profiles(times, old_starts, old_durations)
    new = _profiles(times, starts, durations)
    verdict = np.ones(starts.shape, dtype=np.bool_)
    for old_part, new_part, limit in zip(old, new, (limits.speed, limits.acceleration), strict=True):
        sums = old_part.T @ ways + new_part[:, :, None] * way  # (c, g, k)
        verdict &= np.max(np.einsum("cgk,cgk->cg", sums, sums), axis=1) <= limit**2 * _SLACK
    return verdict


def _profiles(times: Array, starts: Array, durations: Array) -> tuple[Array, Array]:
    """Speeds and accelerations (c, g) of pieces of unit length at times (g,)."""
    u = (times - starts[:, None]) / durations[:, None]
    active = (u >= 0.0) & (u < 1.0)
    rate = math.pi / durations[:, None]
    return (
        np.where(active, 0.5 * rate * np.sin(math.pi * u), 0.0),
        np.where(active, 0.5 * rate**2 * np.cos(math.pi * u), 0.0),
    )
