"""Estimation of every study and task: filters, observer, tare."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from pliant.configuration import Config
from pliant.estimation.joint_acceleration import JointAcceleration
from pliant.estimation.momentum_observer import GAIN
from pliant.quantity import quantity

_NOISE = "sensors of [FFMPC] sec. VI-B; measure yours at rest"


class Estimation(Config):
    """Estimation between sensors and controller."""

    noise_position: float = quantity(
        1e-3, "rad", "standard deviation of the joint positions' noise", assumed=_NOISE, ge=0.0, le=1.0
    )
    noise_velocity: float = quantity(1e-3, "rad/s", "the same of the joint velocities", assumed=_NOISE, ge=0.0, le=10.0)
    noise_force: float = quantity(0.01, "N", "the same of the force sensor", assumed=_NOISE, ge=0.0, le=100.0)
    joint_memory: float | None = quantity(
        None,
        "s",
        "of the joint state filter; 0: no filter; none: 0.3 noise_position / noise_velocity, 3 s at most, for"
        " controllers that compensate, on paths, and in lists of phases that are timed or have delays, else 0",
        ge=0.0,
        le=100.0,
    )
    observer_gain: float | None = quantity(
        None,
        "rad/s",
        f"k of the momentum observer, which runs where the controller asks for a disturbance; none: {GAIN:g}, less"
        " where its noise k M noise_velocity would exceed 1 % of a joint's torque limit",
        gt=0.0,
        le=1e4,
    )
    wrench_cutoff: float | None = quantity(
        None, "Hz", "of a Butterworth filter of the contact wrench; none: unfiltered", gt=0.0, le=1e5
    )
    wrench_stiffness: float | None = quantity(
        None,
        "N/m",
        "believed stiffness with which the motion compensates the delay of that filter; none: the filter alone",
        gt=0.0,
        le=1e8,
    )
    torque: Literal["sensor", "model"] = Field(
        default="sensor",
        description="joint torques from the joints' sensors, or RNEA(q, v, v̇) − τ_ext of the force sensor"
        " ([FFMPC] eq. 37)",
    )
    acceleration_cutoff: float = quantity(
        JointAcceleration.cutoff,
        "Hz",
        "of the joint accelerations with which the inertia of what the force sensor carries is taken off;"
        " higher is less late and lets more of the velocities' noise through",
        gt=0.0,
        le=1e4,
    )
    changing: bool = Field(
        default=False,
        description="the stiffness of what is pressed may change on the way: it is estimated from changes of force and"
        " depth faster than 8 Hz, while the tool slides, too; else from all of them, below 0.02 m/s along the surface",
    )
    tare: Literal["weight", "bias"] | None = Field(
        default=None,
        description="the unexplained reading of the force sensor in the first 20 ms is taken as an unknown weight or as"
        " an offset; none: as contact",
    )
