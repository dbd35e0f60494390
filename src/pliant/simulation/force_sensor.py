"""A force/torque sensor in the robot's structure."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class ForceSensor:
    """Feels the contact at its frame plus the weight and inertia of what it carries.

    With mass 0 it reads the contact wrench alone, as a real sensor does after perfect tool compensation.
    """

    frame: str
    """where it sits, and in whose axes it reads"""
    mass: float = 0.0
    """kg carried beyond the sensor"""
    center: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """m, centre of that mass in the sensor's axes"""
