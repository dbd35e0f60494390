"""Parameters of the haptic exploration, with units and what they do: controls and help are made from them."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import Field

from pliant.configuration import Config


def _in(unit: str) -> dict[str, Any]:
    return {"unit": unit}


class ExplorationConfig(Config):
    """How a target moves so that the contact force becomes the desired one."""

    mode: Literal["adaptive", "paper"] = Field(
        default="adaptive",
        description="adaptive: integral of the force error over the estimated stiffness; paper: the printed algorithm",
    )
    direction: Literal["axes", "normal"] = Field(
        default="axes",
        description="axes: each axis on its own; normal: the target moves along the estimated contact normal only",
    )
    gain: float = Field(
        default=45.0,
        gt=0.0,
        le=300.0,
        description="k_I: how fast the force error decays; keep it below a tenth of the actuator's bandwidth in rad/s",
        json_schema_extra=_in("1/s"),
    )
    speed: float = Field(
        default=0.15, gt=0.0, le=2.0, description="v_max: fastest motion of the offset", json_schema_extra=_in("m/s")
    )
    speed_rotation: float = Field(
        default=0.5, gt=0.0, le=10.0, description="v_max of rotation axes", json_schema_extra=_in("rad/s")
    )
    reset: bool = Field(default=True, description="let the offset return to zero when contact is lost; off: hold it")
    reset_speed: float = Field(
        default=0.1, gt=0.0, le=2.0, description="speed at which the offset returns", json_schema_extra=_in("m/s")
    )
    reset_speed_rotation: float = Field(
        default=0.5, gt=0.0, le=10.0, description="the same for rotation axes", json_schema_extra=_in("rad/s")
    )
    seek: bool = Field(default=False, description="without contact, move against the desired force until it is made")
    seek_speed: float = Field(
        default=0.02, gt=0.0, le=0.5, description="speed of that search", json_schema_extra=_in("m/s")
    )
    seek_speed_rotation: float = Field(
        default=0.1, gt=0.0, le=2.0, description="the same for rotation axes", json_schema_extra=_in("rad/s")
    )
    stiffness_floor: float = Field(
        default=300.0,
        gt=0.0,
        description="least stiffness the estimate may take; lower is faster on soft objects and trusts noise more",
        json_schema_extra=_in("N/m"),
    )
    stiffness_floor_rotation: float = Field(
        default=3.0, gt=0.0, description="the same for rotation axes", json_schema_extra=_in("N·m/rad")
    )
    window: float = Field(
        default=0.020,
        gt=0.0,
        le=0.5,
        description="time over which the stiffness is taken, and time constant of its filter",
        json_schema_extra=_in("s"),
    )
    least_motion: float = Field(
        default=2e-4,
        gt=0.0,
        description="motion of the target within the window below which the estimate is left alone",
        json_schema_extra=_in("m"),
    )
    least_motion_rotation: float = Field(
        default=2e-3, gt=0.0, description="the same for rotation axes", json_schema_extra=_in("rad")
    )
    contact_on: float = Field(
        default=1.0, gt=0.0, description="force above which contact begins", json_schema_extra=_in("N")
    )
    contact_off: float = Field(
        default=0.5, gt=0.0, description="force below which contact ends", json_schema_extra=_in("N")
    )
    contact_on_rotation: float = Field(
        default=0.1, gt=0.0, description="moment above which contact begins", json_schema_extra=_in("N·m")
    )
    contact_off_rotation: float = Field(
        default=0.05, gt=0.0, description="moment below which contact ends", json_schema_extra=_in("N·m")
    )
    contact_filter: float = Field(
        default=0.005,
        ge=0.0,
        le=0.1,
        description="low-pass on the force that begins a contact, so that noise does not; 0 for none",
        json_schema_extra=_in("s"),
    )
    release_time: float = Field(
        default=0.005,
        ge=0.0,
        le=0.5,
        description="how long the force stays low before contact ends",
        json_schema_extra=_in("s"),
    )
    lost_time: float = Field(
        default=0.020,
        ge=0.0,
        le=1.0,
        description="how long the offset waits for a lost contact to come back",
        json_schema_extra=_in("s"),
    )
    unreachable_time: float = Field(
        default=0.05,
        ge=0.0,
        le=5.0,
        description="how long the offset rests at its bound before the force is called unreachable",
        json_schema_extra=_in("s"),
    )
    turn_speed: float = Field(
        default=4e-3,
        gt=0.0,
        le=0.1,
        description="a retreat slower than this ends with a step back at this speed, which the impedance notices",
        json_schema_extra=_in("m/s"),
    )
    turn_speed_rotation: float = Field(
        default=4e-3, gt=0.0, le=0.2, description="the same for rotation axes", json_schema_extra=_in("rad/s")
    )
    turn_time: float = Field(
        default=0.015,
        ge=0.0,
        le=0.1,
        description="how long that step back may last; 0 for none",
        json_schema_extra=_in("s"),
    )
    normal_time: float = Field(
        default=0.05, gt=0.0, le=5.0, description="time constant of the estimated normal", json_schema_extra=_in("s")
    )
    normal_rate: float = Field(
        default=2.0, gt=0.0, le=50.0, description="fastest turn of the estimated normal", json_schema_extra=_in("rad/s")
    )
    normal_cone: float = Field(
        default=0.8,
        gt=0.0,
        le=1.5,
        description="largest angle between the estimated normal and the desired force",
        json_schema_extra=_in("rad"),
    )
    resolution: float = Field(
        default=0.01,
        gt=0.0,
        le=1.0,
        description="mode paper only: sigma, the step as a share of F_d/K_0 and, as printed, a threshold in newtons",
        json_schema_extra=_in("-"),
    )
