"""Typed configuration of the work: table, timetable of the tool, pushes by a person."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from pliant.experiments.config import Config


class Table(Config):
    """The surface that is polished. The tool comes down at y = 0."""

    height: float = Field(
        default=0.01, ge=-10.0, le=10.0, description="z of its surface", json_schema_extra={"unit": "m"}
    )
    height_error: float = Field(
        default=0.0,
        ge=-1.0,
        le=1.0,
        description="by how much the controller believes it higher",
        json_schema_extra={"unit": "m"},
    )
    x: float = Field(
        default=0.65, ge=-10.0, le=10.0, description="x at which the tool comes down", json_schema_extra={"unit": "m"}
    )
    stiffness: float = Field(
        default=1e4, gt=0.0, le=1e8, description="of the contact", json_schema_extra={"unit": "N/m"}
    )
    damping: float = Field(
        default=1e2, ge=0.0, le=1e8, description="of the contact", json_schema_extra={"unit": "N·s/m"}
    )
    friction: float = Field(
        default=0.25, ge=0.0, le=10.0, description="Coulomb coefficient", json_schema_extra={"unit": "1"}
    )
    tilt: float = Field(
        default=0.0,
        ge=-1.5,
        le=1.5,
        description="about the world's x axis, unknown to the controller",
        json_schema_extra={"unit": "rad"},
    )


class Work(Config):
    """What the tool does. Times count from the start of the run."""

    start: float = Field(
        default=0.10,
        gt=0.0,
        le=10.0,
        description="height over the table where the run starts",
        json_schema_extra={"unit": "m"},
    )
    above: float = Field(
        default=0.02,
        gt=0.0,
        le=10.0,
        description="height over the table where reach ends",
        json_schema_extra={"unit": "m"},
    )
    reach: float = Field(
        default=0.5, gt=0.0, le=1e4, description="end of the motion above the table", json_schema_extra={"unit": "s"}
    )
    touch: float = Field(
        default=1.0, gt=0.0, le=1e4, description="end of the descent; contact begins", json_schema_extra={"unit": "s"}
    )
    pressed: float = Field(
        default=2.0, gt=0.0, le=1e4, description="end of the ramp of the force", json_schema_extra={"unit": "s"}
    )
    circle: float = Field(
        default=3.0,
        gt=0.0,
        le=1e4,
        description="start of the circle or of the force steps",
        json_schema_extra={"unit": "s"},
    )
    light: float = Field(
        default=5.0, gt=0.0, le=1e4, description="force at first contact", json_schema_extra={"unit": "N"}
    )
    force: float = Field(
        default=50.0, gt=0.0, le=1e4, description="force of the circle", json_schema_extra={"unit": "N"}
    )
    pattern: Literal["circle", "square"] = Field(
        default="circle", description="a circle under constant force, or force steps on one spot ([FFMPC] VII-B)"
    )
    low: float = Field(
        default=20.0, gt=0.0, le=1e4, description="lower level of the force steps", json_schema_extra={"unit": "N"}
    )
    half_period: float = Field(
        default=1.0,
        ge=1e-3,
        le=1e4,
        description="time on each level of the force steps",
        json_schema_extra={"unit": "s"},
    )
    radius: float = Field(default=0.07, gt=0.0, le=10.0, description="of the circle", json_schema_extra={"unit": "m"})
    speed: float = Field(
        default=3.0, gt=0.0, le=100.0, description="of the circle", json_schema_extra={"unit": "rad/s"}
    )
    ease: float = Field(
        default=0.5,
        ge=1e-3,
        le=1e4,
        description="time in which the circle starts from rest",
        json_schema_extra={"unit": "s"},
    )
    found: bool = Field(default=False, description="contact begins when it is felt, not by the timetable")


class RepeatedPushes(Config):
    """Pushes by a person: a constant force in a random horizontal direction on another frame, again and again."""

    frame: str = Field(default="flange", description="that is pushed")
    force: float = Field(default=20.0, ge=0.0, le=1e4, description="of one push", json_schema_extra={"unit": "N"})
    duration: float = Field(default=0.5, ge=1e-3, le=1e4, description="of one push", json_schema_extra={"unit": "s"})
    gap: float = Field(default=0.8, ge=1e-3, le=1e4, description="between two pushes", json_schema_extra={"unit": "s"})
    start: float = Field(default=4.0, ge=0.0, le=1e4, description="of the first push", json_schema_extra={"unit": "s"})
