"""Warnings about unsafe impedance parameters, before a run."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from pliant.controllers.profiles import ForceProfile, Shape
from pliant.rigid_body import mass_matrix
from pliant.robot import Robot
from pliant.signals import ImpedanceTuning
from pliant.spatial import Array

SAFE_PHASE = 0.4
"""largest ω T_s at which a sampled axis was found stable (a 1-DoF mass becomes unstable at 0.8)"""
_SAFE_TURN = 1.0


@dataclass(frozen=True)
class Advice:
    """One warning about one axis."""

    axis: int
    rule: Literal["sampling", "actuator", "knee"]
    value: float
    """value of the checked quantity, in the unit of the rule: rad, rad/s or J"""
    limit: float
    """its safe limit, in the same unit"""
    message: str


def advise(
    tuning: ImpedanceTuning,
    period: float,
    inertia: npt.ArrayLike,
    *,
    shape: Shape = Shape.EXPONENTIAL,
    torque_bandwidth: float | None = None,
    speed: float = 0.5,
    knee_energy: float = 0.02,
) -> list[Advice]:
    """Checks a tuning against the control period, the inertia it moves and the actuators.

    Args:
        tuning: of k axes.
        period: T_s, s.
        inertia: smallest inertia that each axis feels (k,) or one for all, kg or kg m²; see `smallest_inertia`.
        shape: of the force profile.
        torque_bandwidth: of the actuators, rad/s; None: not checked.
        speed: m/s or rad/s at which the error may cross the knee of the profile.
        knee_energy: J of leakage per crossing that is worth a warning.

    Returns:
        Warnings, none if all is well. Rules: ω T_s ≤ 0.4 with ω = √(K_0/Λ); ω below the actuators' bandwidth; and
        the energy that one sample lets through when the error crosses the knee outward, at most ΔF·v·T_s (half of that
        on average) where the bend is shorter than the motion in one sample.
    """
    inertias = np.broadcast_to(np.asarray(inertia, dtype=np.float64), (tuning.axes,))
    profile = ForceProfile.of(tuning, shape)
    found: list[Advice] = []
    for axis in np.flatnonzero(tuning.stiffness > 0.0).tolist():
        K_0, Lambda = float(tuning.stiffness[axis]), float(inertias[axis])
        omega = math.sqrt(K_0 / Lambda)
        if omega * period > SAFE_PHASE:
            found.append(_sampling(axis, K_0, Lambda, omega, period))
        if torque_bandwidth is not None and torque_bandwidth < omega:
            found.append(_actuator(axis, Lambda, omega, torque_bandwidth))
        leak = _knee_leak(profile, axis, speed, period)
        if leak > knee_energy:
            found.append(_knee(axis, leak, knee_energy, speed))
    return found


def advise_damping(motion_damping: float, late: float) -> tuple[str, ...]:
    """A warning about a damping that the loop is too late for. A mass with a damping of d per s that acts T late is
    stable for d T < π/2 (its speed follows v̇ = −d v(t − T)); beyond 1 it swings.

    Args:
        motion_damping: d, 1/s.
        late: T, s.
    """
    if motion_damping * late <= _SAFE_TURN:
        return ()
    turn = motion_damping * late
    what = "is unstable" if turn >= math.pi / 2.0 else "makes it swing"
    return (
        f"motion_damping of {motion_damping:g} /s {what} in a loop that is {1e3 * late:g} ms late (d T = {turn:.2f},"
        f" stable below π/2); safe: motion_damping ≤ {SAFE_PHASE / late:.3g} /s",
    )


def smallest_inertia(robot: Robot, frame: str, q: npt.ArrayLike | None = None) -> Array:
    """Smallest inertia that a force at a frame can meet: the inverse of the largest mobility J M⁻¹ Jᵀ.

    Args:
        robot: with its inertia.
        frame: where the force acts.
        q: (n,) rad; None: the robot's home.

    Returns:
        (6,): kg three times, kg m² three times (the same value for each direction of a group).
    """
    model, data = robot.model, robot.model.createData()
    q = robot.vector(robot.home if q is None else q, "q")
    J = pin.computeFrameJacobian(model, data, q, robot.frame_id(frame), pin.ReferenceFrame.LOCAL_WORLD_ALIGNED)
    mobility = J @ np.linalg.solve(mass_matrix(model, data, q), J.T)
    linear = 1.0 / np.linalg.eigvalsh(mobility[:3, :3])[-1]
    angular = 1.0 / np.linalg.eigvalsh(mobility[3:, 3:])[-1]
    return np.array([linear] * 3 + [angular] * 3)


def sentences(advices: Iterable[Advice]) -> tuple[str, ...]:
    """The warnings as text; axes with the same one share a sentence."""
    axes: dict[str, list[int]] = {}
    for advice in advices:
        axes.setdefault(advice.message, []).append(advice.axis)
    return tuple(f"axis {', '.join(map(str, group))}: {message}" for message, group in axes.items())


def _sampling(axis: int, K_0: float, Lambda: float, omega: float, period: float) -> Advice:
    safe = Lambda * (SAFE_PHASE / period) ** 2
    message = (
        f"stiffness {K_0:g} on an inertia of {Lambda:.3g} oscillates at {omega:.0f} rad/s, too fast for a"
        f" period of {1e3 * period:g} ms (ω T_s = {omega * period:.2f} > {SAFE_PHASE}); safe: stiffness ≤ {safe:.4g}"
    )
    return Advice(axis, "sampling", omega * period, SAFE_PHASE, message)


def _actuator(axis: int, Lambda: float, omega: float, bandwidth: float) -> Advice:
    safe = Lambda * bandwidth**2
    message = (
        f"the impedance acts at {omega:.0f} rad/s, above the actuators' {bandwidth:.0f} rad/s;"
        f" safe: stiffness ≤ {safe:.4g}"
    )
    return Advice(axis, "actuator", omega, bandwidth, message)


def _knee_leak(profile: ForceProfile, axis: int, speed: float, period: float) -> float:
    """J of leakage in one sample: the force that is held lags behind the rise of the profile within the bend."""
    rise = float(profile.force_max[axis] - profile.knee_force[axis])
    way = speed * period
    if profile.shape in (Shape.EXPONENTIAL_PRINTED, Shape.TANH_PRINTED):
        return rise * way  # a step
    if profile.shape is Shape.EXPONENTIAL:
        rise *= -math.expm1(-way / float(profile.length[axis]))
    else:
        rise *= min(way / float(profile.length[axis]) / 2.0, 1.0)  # steepest slope of the tanh bend: ΔF/(2 w)
    return rise * way


def _knee(axis: int, leak: float, limit: float, speed: float) -> Advice:
    message = (
        f"the profile bends so sharply that one sample leaks up to {leak:.3g} J when the error crosses the knee at"
        f" {speed:g} m/s or rad/s; safe: a larger distance from linear_range x_0 to range x_b, or a smaller force_max"
    )
    return Advice(axis, "knee", leak, limit, message)
