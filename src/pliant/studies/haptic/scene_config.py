"""Typed configuration of what stands around the leg, and of its drives and sensors."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from pliant.configuration import Config
from pliant.quantity import quantity
from pliant.studies.haptic.fields import Vector

_Edge = Annotated[float, Field(ge=1e-4, le=100.0)]  # m
_Scale = Annotated[float, Field(ge=1e-3, le=1e3)]


class Material(Config):
    """Contact properties of a thing. Defaults: the rigid objects of [HapFIC] sec. III."""

    stiffness: float = quantity(1e6, "N/m", "K of every contact point", gt=0.0, le=1e9)
    damping: float = quantity(1e4, "N s/m", "D", ge=0.0, le=1e9)
    friction: float = quantity(0.5, "1", "Coulomb coefficient at rest", ge=0.0, le=10.0)
    friction_moving: float = quantity(0.3, "1", "Coulomb coefficient while sliding", ge=0.0, le=10.0)


SMOOTH = Material(friction=0.0, friction_moving=0.0)
SOFT = Material(stiffness=1e3, damping=1e2)


class Floor(Config):
    """A plane through a point on the world's z axis."""

    height: float = quantity(0.0, "m", "where it meets the world's z axis", ge=-10.0, le=10.0)
    tilt: Vector = quantity((0.0, 0.0, 0.0), "rad", "about the world's x and y axes; the third is not used")
    material: Material = SMOOTH


class BoxConfig(Config):
    """A rigid box."""

    size: tuple[_Edge, _Edge, _Edge] = quantity((0.12, 0.2, 0.2), "m", "edge lengths")
    position: Vector = quantity((0.21, 0.0, 0.1), "m", "of its centre")
    mass: float = quantity(2.0, "kg", "0: fixed to the world", ge=0.0, le=1e5)
    material: Material = Material()


class BallConfig(Config):
    """A soft ball."""

    radius: float = quantity(0.1, "m", "of the ball", ge=1e-4, le=100.0)
    position: Vector = quantity((0.12, 0.0, 0.1), "m", "of its centre")
    mass: float = quantity(0.5, "kg", "0: fixed to the world", ge=0.0, le=1e5)
    material: Material = SOFT


class HapticScene(Config):
    """The things around the leg; contacts follow the explicit law with stiction."""

    floor: Floor | None = Field(default=Floor(), description="none: without")
    box: BoxConfig | None = None
    ball: BallConfig | None = None
    shank: bool = Field(default=False, description="whether the shank touches things, too")


class Hardware(Config):
    """How the leg's joints, drives and sensors behave."""

    compensation: Literal["none", "gravity", "gravity+coriolis"] = Field(
        default="gravity", description="what the leg compensates by itself; the paper does not state it"
    )
    joint_damping: float = quantity(0.0, "N·m s/rad", "in the joints' mechanics", ge=0.0, le=1e4)
    bandwidth: float | None = quantity(
        None, "Hz", "first-order torque response of the drives; none: immediate", gt=0.0, le=1e5
    )
    peak_torque: float | None = quantity(None, "N·m", "largest motor torque; none: the robot's limit", gt=0.0, le=1e6)
    mass_scale: tuple[_Scale, ...] | None = quantity(
        None, "1", "factor on the mass and inertia of each joint's link; none: 1"
    )
    force_noise: float = quantity(0.0, "N", "standard deviation of the force sensor's white noise", ge=0.0, le=1e4)
    force_delay: float = quantity(0.0, "s", "age of the force signal", ge=0.0, le=1.0)
    command_delay: float = quantity(0.0, "s", "from a measurement to the effect of its command", ge=0.0, le=1.0)

    @property
    def perfect(self) -> bool:
        """Whether nothing stands between controller and plant."""
        return (
            self.bandwidth is None
            and self.peak_torque is None
            and not (self.force_noise or self.force_delay or self.command_delay)
        )
