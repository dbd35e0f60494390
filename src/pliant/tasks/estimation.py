"""What stands between the sensors and the controller, in every study and task."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from pliant.configuration import Config


class Estimation(Config):
    """What stands between the sensors and the controller."""

    joint_memory: float | None = Field(
        default=None,
        ge=0.0,
        le=100.0,
        description="of the joint state filter; 0: no filter; none: where a path is polished or wiped 0.3 s for"
        " controllers that compensate, else 0",
        json_schema_extra={"unit": "s"},
    )
    observer_gain: float = Field(
        default=30.0,
        gt=0.0,
        le=1e4,
        description="of the momentum observer, which runs where the controller asks for a disturbance",
        json_schema_extra={"unit": "rad/s"},
    )
    wrench_cutoff: float | None = Field(
        default=None,
        gt=0.0,
        le=1e5,
        description="of a Butterworth filter of the contact wrench; none: unfiltered",
        json_schema_extra={"unit": "Hz"},
    )
    acceleration_cutoff: float = Field(
        default=200.0,
        gt=0.0,
        le=1e4,
        description="of the joint accelerations with which the inertia of what the force sensor carries is taken off;"
        " higher is less late and lets more of the velocities' noise through",
        json_schema_extra={"unit": "Hz"},
    )
    tare: Literal["weight", "bias"] | None = Field(
        default=None,
        description="what the force sensor reads in the first 20 ms, beyond what is known, counts as an unknown weight"
        " or as an offset; none: it counts as contact",
    )
