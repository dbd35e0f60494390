"""Typed configuration of table, timing of the tool, and pushes. The defaults are those of the task file."""

from __future__ import annotations

import math
from typing import Literal

from pydantic import Field

from pliant.configuration import Config
from pliant.quantity import quantity
from pliant.studies.polishing.paper_task import BALL_RADIUS, START, TABLE, end_of, forces, phase

_LIGHT, _FORCE = forces("ramp")
_TURN = phase("circle").motion
assert _TURN is not None
_ABOVE = phase("reach").target
assert _ABOVE is not None
_LONGEST = 3600.0  # s


def _over_table(height: float) -> float:
    """m from the table to the ball. Args: height: m, of its middle in the world."""
    return round(height - BALL_RADIUS - TABLE.pose.xyz[2], 9)


class Table(Config):
    """The surface that is polished. The tool comes down at y = 0."""

    height: float = quantity(TABLE.pose.xyz[2], "m", "z of its surface", ge=-10.0, le=10.0)
    height_error: float = quantity(0.0, "m", "height error of the table in the controller", ge=-1.0, le=1.0)
    x: float = quantity(TABLE.pose.xyz[0], "m", "x at which the tool comes down", ge=-10.0, le=10.0)
    stiffness: float = quantity(TABLE.stiffness, "N/m", "of the contact", gt=0.0, le=1e8)
    damping: float = quantity(TABLE.damping, "N·s/m", "of the contact", ge=0.0, le=1e8)
    friction: float = quantity(TABLE.friction, "1", "Coulomb coefficient", ge=0.0, le=10.0)
    tilt: float = quantity(0.0, "rad", "about the world's x axis, unknown to the controller", ge=-1.5, le=1.5)


class Work(Config):
    """Motion and force of the tool. Times count from the start of the run."""

    start: float = quantity(
        _over_table(START.xyz[2]), "m", "height over the table where the run starts", gt=0.0, le=10.0
    )
    above: float = quantity(_over_table(_ABOVE[2]), "m", "height over the table where reach ends", gt=0.0, le=10.0)
    reach: float = quantity(end_of("reach"), "s", "end of the motion above the table", gt=0.0, le=_LONGEST)
    touch: float = quantity(end_of("track"), "s", "end of the descent; contact begins", gt=0.0, le=_LONGEST)
    pressed: float = quantity(end_of("ramp"), "s", "end of the ramp of the force", gt=0.0, le=_LONGEST)
    circle: float = quantity(end_of("contact"), "s", "start of the circle or of the force steps", gt=0.0, le=_LONGEST)
    light: float = quantity(_LIGHT, "N", "force at first contact", gt=0.0, le=1e4)
    force: float = quantity(_FORCE, "N", "force of the circle", gt=0.0, le=1e4)
    pattern: Literal["circle", "square"] = Field(
        default="circle", description="a circle under constant force, or force steps on one spot ([FFMPC] VII-B)"
    )
    low: float = quantity(20.0, "N", "lower level of the force steps", gt=0.0, le=1e4)
    half_period: float = quantity(1.0, "s", "time on each level of the force steps", ge=1e-3, le=1e4)
    radius: float = quantity(_TURN.size[0], "m", "of the circle", gt=0.0, le=10.0)
    speed: float = quantity(2.0 * math.pi / _TURN.period, "rad/s", "of the circle", ge=1e-3, le=100.0)
    ease: float = quantity(_TURN.ramp, "s", "time in which the circle starts from rest", ge=1e-3, le=1e4)
    stop: float | None = quantity(
        None, "s", "when the circle has ended and the tool rests, pressed on; none: it goes on", gt=0.0, le=1e4
    )
    found: bool = Field(default=False, description="contact begins when it is detected, not by the timetable")


class RepeatedPushes(Config):
    """Pushes by a person: a constant force in a random horizontal direction on another frame, again and again."""

    frame: str = Field(default="flange", description="that is pushed")
    force: float = quantity(20.0, "N", "of one push", ge=0.0, le=1e4)
    duration: float = quantity(0.5, "s", "of one push", ge=1e-3, le=1e4)
    gap: float = quantity(0.8, "s", "between two pushes", ge=1e-3, le=1e4)
    start: float = quantity(4.0, "s", "of the first push", ge=0.0, le=1e4)
