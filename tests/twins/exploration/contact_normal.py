"""Estimates the normal of a contact from its force."""

from __future__ import annotations

import math

Vector = tuple[float, float, float]

_SLIDING = 5e-3  # m/s; slower motion does not determine the direction of friction


def turned_normal(
    normal: Vector,
    force: Vector,
    velocity: Vector,
    least_force: float,
    period: float,
    time_constant: float,
    rate: float,
) -> Vector:
    """Turns an estimated normal towards the direction given by the contact force while the frame slides.

    Friction acts against the sliding, so that the force without its part along the velocity is normal. At rest,
    stiction may have any direction within the friction cone, so that the estimate is not changed.

    Args:
        normal: unit vector, world axes, on the side of the robot.
        force: of the environment on the robot, N.
        velocity: of the frame along its path, m/s.
        least_force: N, below it the force is not used.
        period: s.
        time_constant: s.
        rate: fastest turn, rad/s.

    Returns:
        A unit vector.
    """
    speed = math.hypot(*velocity)
    if speed < _SLIDING:
        return normal
    along = _dot(force, velocity) / (speed * speed)
    clean = (force[0] - along * velocity[0], force[1] - along * velocity[1], force[2] - along * velocity[2])
    length = math.hypot(*clean)
    if length < least_force:
        return normal
    seen = (clean[0] / length, clean[1] / length, clean[2] / length)
    angle = angle_between(normal, seen)
    share = min(period / (time_constant + period), rate * period / angle if angle > 0.0 else 1.0)
    return unit_blend(normal, seen, share)


def within_cone(normal: Vector, axis: Vector, half_angle: float) -> Vector:
    """The normal, or the direction nearest to it within `half_angle`, rad, of the unit vector `axis`."""
    angle = angle_between(axis, normal)
    if angle <= half_angle:
        return normal
    across = (
        normal[0] - math.cos(angle) * axis[0],
        normal[1] - math.cos(angle) * axis[1],
        normal[2] - math.cos(angle) * axis[2],
    )
    length = math.hypot(*across)
    if length < 1e-9:
        return axis
    s, c = math.sin(half_angle) / length, math.cos(half_angle)
    return (c * axis[0] + s * across[0], c * axis[1] + s * across[1], c * axis[2] + s * across[2])


def angle_between(a: Vector, b: Vector) -> float:
    """Angle of two unit vectors, rad."""
    return math.acos(min(max(_dot(a, b), -1.0), 1.0))


def unit_blend(a: Vector, b: Vector, share: float) -> Vector:
    """The unit vector a fraction of the way from a to b; a if they are opposite."""
    x, y, z = (p + share * (q - p) for p, q in zip(a, b, strict=True))
    length = math.sqrt(x * x + y * y + z * z)
    return (x / length, y / length, z / length) if length > 1e-9 else a


def _dot(a: Vector, b: Vector) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
