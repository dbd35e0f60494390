"""Loads on a force/torque sensor: mass, inertia and bias."""

from __future__ import annotations

from dataclasses import dataclass

from pliant.spatial import symmetric

_Vector6 = tuple[float, float, float, float, float, float]
_NOTHING: _Vector6 = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


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

    @property
    def row(self) -> tuple[float, tuple[float, float, float], _Vector6, list[float]]:
        """Mass, centre, bias and inertia (9,) as the compiled estimators take them."""
        return self.mass, self.center, self.bias, symmetric(self.inertia).ravel().tolist()
