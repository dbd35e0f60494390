"""What a load makes a sensor read."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pliant.estimation.carried_mass import CarriedMass
from pliant.spatial import Array, cross, symmetric


@dataclass(frozen=True, slots=True)
class SensorMotion:
    """How a sensor moves, each (3,) in its own axes."""

    acceleration: Array
    """of its origin minus gravity, m/s²"""
    spin: Array
    """ω, rad/s"""
    turning: Array
    """dω/dt, rad/s²"""


def reading(load: CarriedMass, motion: SensorMotion) -> Array:
    """What it makes the sensor read without any contact, (6,) in the sensor's axes."""
    center, inertia, spin = np.array(load.center), symmetric(load.inertia), motion.spin
    at_center = motion.acceleration + cross(motion.turning, center) + cross(spin, cross(spin, center))
    force = -load.mass * at_center
    moment = cross(center, force) - inertia @ motion.turning - cross(spin, inertia @ spin)
    return np.concatenate([force, moment]) + np.array(load.bias)


def both(load: CarriedMass, other: CarriedMass) -> CarriedMass:
    """Both together. The turning inertia of `other` counts about its own centre, which is right for a point."""
    mass = load.mass + other.mass
    if other.mass == 0.0:
        center = np.array(load.center)
    else:
        center = (load.mass * np.array(load.center) + other.mass * np.array(other.center)) / mass
    bias = np.array(load.bias) + np.array(other.bias)
    c, b = center.tolist(), bias.tolist()
    return CarriedMass(mass, (c[0], c[1], c[2]), (b[0], b[1], b[2], b[3], b[4], b[5]), load.inertia)
