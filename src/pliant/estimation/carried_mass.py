"""Loads on a force/torque sensor: mass, inertia and bias."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pliant.spatial import Array, cross, symmetric

_Vector6 = tuple[float, float, float, float, float, float]
_NOTHING: _Vector6 = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class SensorMotion:
    """How a sensor moves, each (3,) in its own axes."""

    acceleration: Array
    """of its origin minus gravity, m/s²"""
    spin: Array
    """ω, rad/s"""
    turning: Array
    """dω/dt, rad/s²"""


@dataclass(frozen=True)
class CarriedMass:
    """Mass and inertia beyond a sensor, and its bias; their effect is subtracted from the reading."""

    mass: float = 0.0
    """kg"""
    center: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """m, in the sensor's axes"""
    bias: _Vector6 = _NOTHING
    """(6,) what the sensor reads without any load, in its own axes, N and N·m"""
    inertia: _Vector6 = _NOTHING
    """xx, yy, zz, xy, xz, yz about the centre in the sensor's axes, kg m²"""

    def reading(self, motion: SensorMotion) -> Array:
        """The sensor's reading without contact, (6,) in the sensor's axes.

        Newton and Euler about the sensor's origin: f = −m (a + α × c + ω × (ω × c) − g), μ = c × f − I α − ω × I ω.
        """
        center, inertia, spin = np.array(self.center), symmetric(self.inertia), motion.spin
        at_center = motion.acceleration + cross(motion.turning, center) + cross(spin, cross(spin, center))
        force = -self.mass * at_center
        moment = cross(center, force) - inertia @ motion.turning - cross(spin, inertia @ spin)
        return np.concatenate([force, moment]) + np.array(self.bias)

    def plus(self, other: CarriedMass) -> CarriedMass:
        """Both loads together. The inertia of `other` is taken about its own centre of mass, which is right for a point
        mass."""
        mass = self.mass + other.mass
        if other.mass == 0.0:
            center = np.array(self.center)
        else:
            center = (self.mass * np.array(self.center) + other.mass * np.array(other.center)) / mass
        bias = np.array(self.bias) + np.array(other.bias)
        c, b = center.tolist(), bias.tolist()
        return CarriedMass(mass, (c[0], c[1], c[2]), (b[0], b[1], b[2], b[3], b[4], b[5]), self.inertia)
