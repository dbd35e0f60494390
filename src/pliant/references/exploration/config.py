"""Parameters of the haptic exploration with units and texts, from which controls and help are made."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from pliant.configuration import Config
from pliant.quantity import quantity


class ExplorationConfig(Config):
    """Motion of a target that regulates the contact force."""

    mode: Literal["adaptive", "paper"] = Field(
        default="adaptive",
        description="adaptive: integral of the force error over the estimated stiffness; paper: the printed algorithm",
    )
    direction: Literal["axes", "normal"] = Field(
        default="axes",
        description="axes: each axis on its own; normal: the target moves along the estimated contact normal only",
    )
    gain: float = quantity(
        45.0,
        "1/s",
        "k_I: how fast the force error decays; keep it below a tenth of the actuator's bandwidth in rad/s",
        gt=0.0,
        le=300.0,
    )
    speed: float = quantity(0.15, "m/s", "v_max: fastest motion of the offset", gt=0.0, le=2.0)
    speed_rotation: float = quantity(0.5, "rad/s", "v_max of rotation axes", gt=0.0, le=10.0)
    reset: bool = Field(default=True, description="return the offset to zero when contact is lost; off: hold it")
    reset_speed: float = quantity(0.1, "m/s", "speed at which the offset returns", gt=0.0, le=2.0)
    reset_speed_rotation: float = quantity(0.5, "rad/s", "the same for rotation axes", gt=0.0, le=10.0)
    seek: bool = Field(
        default=False, description="without contact, move against the desired force until contact is made"
    )
    seek_speed: float = quantity(0.02, "m/s", "speed of that search", gt=0.0, le=0.5)
    seek_speed_rotation: float = quantity(0.1, "rad/s", "the same for rotation axes", gt=0.0, le=2.0)
    stiffness_floor: float = quantity(
        300.0,
        "N/m",
        "lower bound of the estimated stiffness; a lower value is faster on soft objects and more sensitive to noise",
        gt=0.0,
    )
    stiffness_floor_rotation: float = quantity(3.0, "N·m/rad", "the same for rotation axes", gt=0.0)
    window: float = quantity(
        0.020, "s", "time window of the stiffness estimate, and time constant of its filter", gt=0.0, le=0.5
    )
    least_motion: float = quantity(
        2e-4, "m", "motion of the target within the window below which the estimate is not updated", gt=0.0
    )
    least_motion_rotation: float = quantity(2e-3, "rad", "the same for rotation axes", gt=0.0)
    contact_on: float = quantity(1.0, "N", "force above which contact begins", gt=0.0)
    contact_off: float = quantity(0.5, "N", "force below which contact ends", gt=0.0)
    contact_on_rotation: float = quantity(0.1, "N·m", "moment above which contact begins", gt=0.0)
    contact_off_rotation: float = quantity(0.05, "N·m", "moment below which contact ends", gt=0.0)
    contact_filter: float = quantity(
        0.005, "s", "low-pass on the force that begins a contact, so that noise does not; 0 for none", ge=0.0, le=0.1
    )
    release_time: float = quantity(
        0.005, "s", "time for which the force must be low before contact ends", ge=0.0, le=0.5
    )
    lost_time: float = quantity(0.020, "s", "time for which the offset is held after contact is lost", ge=0.0, le=1.0)
    unreachable_time: float = quantity(
        0.05, "s", "time at the bound of the offset after which the force is reported as unreachable", ge=0.0, le=5.0
    )
    turn_speed: float = quantity(
        4e-3,
        "m/s",
        "a retreat slower than this ends with a step back at this speed, which makes the impedance switch",
        gt=0.0,
        le=0.1,
    )
    turn_speed_rotation: float = quantity(4e-3, "rad/s", "the same for rotation axes", gt=0.0, le=0.2)
    turn_time: float = quantity(0.015, "s", "longest duration of that step back; 0 for none", ge=0.0, le=0.1)
    normal_time: float = quantity(0.05, "s", "time constant of the estimated normal", gt=0.0, le=5.0)
    normal_rate: float = quantity(2.0, "rad/s", "fastest turn of the estimated normal", gt=0.0, le=50.0)
    normal_cone: float = quantity(
        0.8, "rad", "largest angle between the estimated normal and the desired force", gt=0.0, le=1.5
    )
    resolution: float = quantity(
        0.01,
        "-",
        "mode paper only: sigma, the step as a share of F_d/K_0 and, as printed, a threshold in newtons",
        gt=0.0,
        le=1.0,
    )
