"""What phases say beside their targets: curves about them, and wrenches that change."""

from __future__ import annotations

from itertools import pairwise
from typing import Literal

from pydantic import Field, model_validator

from pliant.configuration import Config
from pliant.quantity import quantity
from pliant.tasks.parts import Vector


class CurveConfig(Config):
    """A curve that is run again and again."""

    size: tuple[float, float] = quantity(
        (0.1, 0.2), "m", "amplitudes across and up; of a line the first alone, of a circle the first is its radius"
    )
    period: float = quantity(4.0, "s", "T of a lemniscate or circle", ge=0.01, le=1e4)
    peak_speed: float = quantity(0.4, "m/s", "of a line", gt=0.0, le=100.0)
    ramp: float = quantity(2.0, "s", "in which the motion starts from rest", ge=0.0, le=1e4)
    across: Vector | None = Field(
        default=None,
        description="a direction; none: across the frame's z axis, level; of a phase's motion x of its frame",
    )
    up: Vector | None = Field(
        default=None,
        description="a direction; none: across the frame's z axis, as upright as is; of a phase's motion y of its"
        " frame",
    )


class PhaseMotion(CurveConfig):
    """A curve that begins at the target of its phase."""

    shape: Literal["lemniscate", "line", "circle", "hold", "stop"] = Field(
        description="lemniscate: across·sin(4πt/T) and up·sin(2πt/T); line: to and fro; circle: its middle lies across"
        " from the target, and it sets out upwards; hold: no motion; stop: the motion of the phase before comes to rest"
        " within `ramp`, in a timed list"
    )

    @model_validator(mode="after")
    def _comes_to_rest_in_time(self) -> PhaseMotion:
        if self.shape == "stop" and self.ramp == 0.0:
            raise ValueError("a motion cannot stop within 0 s: give its ramp")
        return self


class WrenchProfile(Config):
    """A desired wrench that changes in a phase."""

    times: tuple[float, ...] = quantity(..., "s", "since the phase began, increasing", min_length=1)
    wrench: tuple[tuple[float, ...], ...] = quantity(
        ..., "N, N·m", "at each of the times; three axes, or six; the last one is held", min_length=1
    )
    shape: Literal["ramp", "step", "smooth"] = Field(
        default="ramp",
        description="between two times: a straight line, the earlier value until the later time, or a quintic from rest"
        " to rest",
    )

    @model_validator(mode="after")
    def _consistent(self) -> WrenchProfile:
        if len(self.times) != len(self.wrench):
            raise ValueError(f"a profile has one wrench a time, got {len(self.times)} and {len(self.wrench)}")
        if any(late <= early for early, late in pairwise(self.times)):
            raise ValueError(f"the times of a profile increase, got {list(self.times)}")
        odd = next((row for row in self.wrench if len(row) not in (3, 6)), None)
        if odd is not None:
            raise ValueError(f"a wrench has three or six axes, got {len(odd)}")
        return self
