"""Typed configuration of the work: table, timetable of the tool, pushes by a person."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from pliant.configuration import Config
from pliant.quantity import quantity


class Table(Config):
    """The surface that is polished. The tool comes down at y = 0."""

    height: float = quantity(0.01, "m", "z of its surface", ge=-10.0, le=10.0)
    height_error: float = quantity(0.0, "m", "by how much the controller believes it higher", ge=-1.0, le=1.0)
    x: float = quantity(0.65, "m", "x at which the tool comes down", ge=-10.0, le=10.0)
    stiffness: float = quantity(1e4, "N/m", "of the contact", gt=0.0, le=1e8)
    damping: float = quantity(1e2, "N·s/m", "of the contact", ge=0.0, le=1e8)
    friction: float = quantity(0.25, "1", "Coulomb coefficient", ge=0.0, le=10.0)
    tilt: float = quantity(0.0, "rad", "about the world's x axis, unknown to the controller", ge=-1.5, le=1.5)


class Work(Config):
    """What the tool does. Times count from the start of the run."""

    start: float = quantity(0.10, "m", "height over the table where the run starts", gt=0.0, le=10.0)
    above: float = quantity(0.02, "m", "height over the table where reach ends", gt=0.0, le=10.0)
    reach: float = quantity(0.5, "s", "end of the motion above the table", gt=0.0, le=1e4)
    touch: float = quantity(1.0, "s", "end of the descent; contact begins", gt=0.0, le=1e4)
    pressed: float = quantity(2.0, "s", "end of the ramp of the force", gt=0.0, le=1e4)
    circle: float = quantity(3.0, "s", "start of the circle or of the force steps", gt=0.0, le=1e4)
    light: float = quantity(5.0, "N", "force at first contact", gt=0.0, le=1e4)
    force: float = quantity(50.0, "N", "force of the circle", gt=0.0, le=1e4)
    pattern: Literal["circle", "square"] = Field(
        default="circle", description="a circle under constant force, or force steps on one spot ([FFMPC] VII-B)"
    )
    low: float = quantity(20.0, "N", "lower level of the force steps", gt=0.0, le=1e4)
    half_period: float = quantity(1.0, "s", "time on each level of the force steps", ge=1e-3, le=1e4)
    radius: float = quantity(0.07, "m", "of the circle", gt=0.0, le=10.0)
    speed: float = quantity(3.0, "rad/s", "of the circle", gt=0.0, le=100.0)
    ease: float = quantity(0.5, "s", "time in which the circle starts from rest", ge=1e-3, le=1e4)
    stop: float | None = quantity(
        None, "s", "when the circle has ended and the tool rests, pressed on; none: it goes on", gt=0.0, le=1e4
    )
    found: bool = Field(default=False, description="contact begins when it is felt, not by the timetable")


class RepeatedPushes(Config):
    """Pushes by a person: a constant force in a random horizontal direction on another frame, again and again."""

    frame: str = Field(default="flange", description="that is pushed")
    force: float = quantity(20.0, "N", "of one push", ge=0.0, le=1e4)
    duration: float = quantity(0.5, "s", "of one push", ge=1e-3, le=1e4)
    gap: float = quantity(0.8, "s", "between two pushes", ge=1e-3, le=1e4)
    start: float = quantity(4.0, "s", "of the first push", ge=0.0, le=1e4)
