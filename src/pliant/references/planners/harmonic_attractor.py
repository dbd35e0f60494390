"""The harmonic planner of [HapFIC] Tiseo et al. 2021, eq. 2-3, as printed and corrected, for comparison.

It integrates an attractor's acceleration. As printed, the convergence phase uses the absolute position where the
error is meant, and an amplitude without sign: it gets stuck or runs away, depending on where the origin lies and on
the sign of the step. Corrected, the acceleration is (2A/|x̃_T0|)(x̃ − x̃_T0/2) with A_i = A |d_i|/d; a target that
changes on the way still makes it overshoot, which the superposition cannot.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace


@dataclass(frozen=True)
class AttractorAxis:
    """One axis between two ticks."""

    position: float
    """m"""
    velocity: float = 0.0
    """m/s"""
    target: float = 0.0
    """m"""
    turning: float = 0.0
    """x̃_T0, error at which the convergence began, m"""
    converging: bool = False


@dataclass(frozen=True)
class AttractorPlan:
    """The axes of one frame."""

    axes: tuple[AttractorAxis, ...]
    amplitude: float = 0.0
    """A = 2 v_max²/d, m/s²"""
    distance: float = 0.0
    """d, m"""


@dataclass(frozen=True)
class AttractorSettings:
    """Parameters of the printed planner."""

    speed: float = 0.3
    """v_max, m/s: peak speed of a motion from rest"""
    acceleration: float = 5.0
    """a_max, m/s²: of the divergence phase"""
    stiffness: float = 400.0
    """K/M_d, 1/s²: of the divergence phase"""
    printed: bool = False
    """the convergence phase exactly as printed"""


def start(position: tuple[float, ...]) -> AttractorPlan:
    """At rest at a position (k,), m."""
    return AttractorPlan(tuple(AttractorAxis(x, target=x) for x in position))


def retargeted(plan: AttractorPlan, target: tuple[float, ...], settings: AttractorSettings) -> AttractorPlan:
    """A new target (k,), m: the convergence starts from here."""
    way = [b - axis.position for axis, b in zip(plan.axes, target, strict=True)]
    distance = math.hypot(*way)
    if distance == 0.0:
        return replace(plan, axes=tuple(replace(a, target=b) for a, b in zip(plan.axes, target, strict=True)))
    axes = tuple(
        replace(axis, target=b, turning=d, converging=d != 0.0)
        for axis, b, d in zip(plan.axes, target, way, strict=True)
    )
    return AttractorPlan(axes, 2.0 * settings.speed**2 / distance, distance)


def advanced(plan: AttractorPlan, period: float, settings: AttractorSettings) -> AttractorPlan:
    """The state one period in s later."""
    return replace(plan, axes=tuple(_advanced(axis, plan, period, settings) for axis in plan.axes))


def _advanced(axis: AttractorAxis, plan: AttractorPlan, period: float, settings: AttractorSettings) -> AttractorAxis:
    error = axis.target - axis.position
    approaching = error * axis.velocity > 0.0
    converging, turning = axis.converging, axis.turning
    if converging and error * turning <= 0.0:
        converging = False  # arrived, or past the target
    elif not converging and approaching:
        converging, turning = True, error
    push = _acceleration(axis, error, turning, plan, settings, converging)
    velocity = axis.velocity + push * period
    return AttractorAxis(axis.position + velocity * period, velocity, axis.target, turning, converging)


def _acceleration(
    axis: AttractorAxis,
    error: float,
    turning: float,
    plan: AttractorPlan,
    settings: AttractorSettings,
    converging: bool,
) -> float:
    """[HapFIC] eq. 3, m/s²."""
    if not converging:
        return math.copysign(min(settings.stiffness * abs(error), settings.acceleration), error)
    if settings.printed:
        return 2.0 * plan.amplitude / turning * (axis.position - 0.5 * turning)
    # The share A_i belongs to the motion planned at the last target; a new convergence keeps its frequency.
    share = plan.amplitude / plan.distance * abs(turning) if plan.distance > 0.0 else 0.0
    return 2.0 * share / abs(turning) * (error - 0.5 * turning)
