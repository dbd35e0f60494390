"""A force/torque sensor in the robot's structure."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np

from pliant.spatial import Array, cross, symmetric


@dataclass(frozen=True)
class ForceSensor:
    """Measures the contact wrench at its frame plus weight and inertia of its load.

    With mass 0 it reads the contact wrench alone, as a real sensor does after perfect tool compensation.
    """

    frame: str
    """where it sits, and in whose axes it reads"""
    mass: float = 0.0
    """kg carried beyond the sensor"""
    center: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """m, centre of that mass in the sensor's axes"""
    inertia: tuple[float, float, float, float, float, float] = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    """xx, yy, zz, xy, xz, yz about that centre in the sensor's axes, kg m²"""


def sensor_reading(
    model: mujoco.MjModel, data: mujoco.MjData, sensor: ForceSensor, site: int, felt: Iterable[tuple[int, Array]]
) -> Array:
    """Reading of a sensor, (6,) at its frame and in its axes.

    Args:
        model: compiled.
        data: after a step.
        sensor: which one.
        site: of its frame.
        felt: (site, wrench (6,) at that site in world axes) of every contact beyond it.
    """
    R_world_sensor = data.site_xmat[site].reshape(3, 3)
    force, moment = np.zeros(3), np.zeros(3)
    for at, wrench in felt:
        force += wrench[:3]
        moment += wrench[3:] + cross(data.site_xpos[at] - data.site_xpos[site], wrench[:3])
    reading = np.concatenate([R_world_sensor.T @ force, R_world_sensor.T @ moment])
    if sensor.mass > 0.0:
        reading += _carried(model, data, sensor, site)
    return reading


def _carried(model: mujoco.MjModel, data: mujoco.MjData, sensor: ForceSensor, site: int) -> Array:
    """Weight and inertial force of the mass behind a sensor, at its frame and in its axes, (6,)."""
    mujoco.mj_rnePostConstraint(model, data)
    motion = np.zeros(6)  # angular first; linear acceleration minus gravity
    mujoco.mj_objectAcceleration(model, data, mujoco.mjtObj.mjOBJ_SITE, site, motion, 1)
    spin = np.zeros(6)
    mujoco.mj_objectVelocity(model, data, mujoco.mjtObj.mjOBJ_SITE, site, spin, 1)
    center, inertia = np.array(sensor.center), symmetric(sensor.inertia)
    turning, omega = motion[:3], spin[:3]
    acceleration = motion[3:] + cross(turning, center) + cross(omega, cross(omega, center))
    force = -sensor.mass * acceleration
    moment = cross(center, force) - inertia @ turning - cross(omega, inertia @ omega)
    return np.concatenate([force, moment])


def sensor_readings(
    model: Any,
    data: Any,
    sensors: Sequence[ForceSensor],
    sites: Mapping[str, int],
    felt: Mapping[ForceSensor, Sequence[str]],
    wrenches: Mapping[str, Array],
) -> dict[str, Array]:
    """Frame of each sensor → what it reads now.

    Args:
        model, data: of MuJoCo.
        sensors: to be read.
        sites: frame → its site.
        felt: sensor → frames whose contacts it measures.
        wrenches: frame → true contact wrench (6,).
    """
    readings: dict[str, Array] = {}
    for sensor in sensors:
        felt_here = [(sites[frame], wrenches[frame]) for frame in felt[sensor]]
        readings[sensor.frame] = sensor_reading(model, data, sensor, sites[sensor.frame], felt_here)
    return readings
