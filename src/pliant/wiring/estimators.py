"""The chain of estimators that a controller needs."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

from pliant.entries import Believed
from pliant.estimation import (
    Butterworth,
    CarriedMass,
    ComplementaryForce,
    DirectEstimator,
    EnvironmentEstimator,
    FilteredEstimator,
    FitConfig,
    JointAcceleration,
    JointStateFilter,
    ModelledTorqueEstimator,
    MomentumObserver,
    SurfaceEstimator,
    SurfaceFitConfig,
    Tare,
    WrenchEstimator,
)
from pliant.interfaces import Estimator, Needs
from pliant.robot import Robot
from pliant.surfaces import PlaneSurface
from pliant.wiring.noise import Noise

_SLIDING = 0.02  # m/s; faster than that, an unknown tilt looks like a soft table
_FIT_CUTOFF = 30.0  # Hz
_STIFF = 3e4  # N/m; where more is believed, a softer estimate is not used: tilt and noise look like a soft contact
_REACH = 0.01  # m; as far as a soft estimate holds where the stiffness changes
_CHANGING = FitConfig(cutoff=_FIT_CUTOFF, drift=8.0, memory=150.0, least_force=0.0, least_motion=0.0)
"""for a stiffness that changes: all samples count, so that old ones are forgotten with time; the noise is 6 µm after
both filters, as measured after the joint state filter on an arm with the flaws of [FFMPC] sec. VI-B"""


Load = tuple[Mapping[str, CarriedMass], Mapping[str, str]]
"""sensor → what it is known to carry; sensor → the frame beyond it that touches"""


@dataclass(frozen=True)
class SensorFilters:
    """Filters of the sensor signals."""

    felt: bool = True
    """whether there is a force sensor"""
    velocity_gain: float = 1.0
    """share of a new sample in the joint velocity; 1 filters nothing"""
    wrench_cutoff: float | None = None
    """Hz, of a Butterworth filter of contact wrenches; None: unfiltered"""
    wrench_stiffness: float | None = None
    """N/m, stiffness with which the motion compensates the delay of that filter; None: the filter alone"""
    torque: Literal["sensor", "model"] = "sensor"
    """source of the joint torques"""
    joint_memory: float | None = None
    """s, of the joint state filter; 0: none; None: what suits the noise, for controllers that need positions without"""
    observer_gain: float | None = None
    """rad/s, of the momentum observer; None: what suits the noise"""
    noise: Noise = field(default_factory=Noise)
    """as it is assumed"""
    carried: Mapping[str, CarriedMass] = field(default_factory=dict[str, CarriedMass])
    """sensor → what it is known to carry"""
    contact_frames: Mapping[str, str] = field(default_factory=dict[str, str])
    """sensor → the frame beyond it that touches"""
    acceleration_cutoff: float = JointAcceleration.cutoff
    """Hz, of the joint accelerations with which what a sensor carries is taken off"""
    changing: bool = False
    """whether the stiffness may change on the way, and is estimated while the tool slides, too"""
    tare: Literal["weight", "bias"] | None = None
    """taring of unknown loads of the force sensor at the start; None: no taring"""
    surface: SurfaceFitConfig | None = None
    """how the pressed surface's tilt is estimated from the path of the contact; None: it is as believed"""


def estimator_for(needs: Needs, robot: Robot, believed: Believed, sensing: SensorFilters) -> Estimator[Any]:
    """Measurement → what a controller needs: filtered, with environment and disturbance where it asks for them.

    The environment is estimated, and the normal force modelled, along the normal of the believed surface; along the
    world's z axis where there is none.
    """
    gain, period = sensing.velocity_gain, believed.period
    normal = (0.0, 0.0, 1.0) if believed.surface is None else believed.surface
    tare = None if sensing.tare is None else Tare(kind=sensing.tare)
    felt: Estimator[Any] = (
        WrenchEstimator(
            robot,
            sensing.carried,
            velocity_gain=gain,
            contact_frames=sensing.contact_frames,
            acceleration=JointAcceleration(sensing.acceleration_cutoff),
            tare=tare,
        )
        if sensing.felt
        else DirectEstimator(gain)
    )
    felt = _filtered(felt, robot, believed, sensing)
    memory = sensing.joint_memory
    if memory is None:
        memory = sensing.noise.joint_memory() if needs.calm else 0.0
    if memory > 0.0:
        felt = JointStateFilter(felt, memory)
    if sensing.surface is not None and believed.presses is not None and believed.surface is not None:
        felt = SurfaceEstimator(felt, robot, believed.presses, believed.surface, sensing.surface)
    if needs.environment:
        frame = believed.presses or believed.frames[0]
        if sensing.changing:
            kept = math.inf if believed.stiffness is None else believed.stiffness
            fit = _CHANGING.model_copy(update={"noise_depth": sensing.noise.depth(memory)})
            felt = EnvironmentEstimator(felt, robot, frame, period, normal=normal, config=fit, reach=_REACH, kept=kept)
        else:
            fit = FitConfig(cutoff=_FIT_CUTOFF, least_force=sensing.noise.least_force(_FIT_CUTOFF, period))
            known = believed.stiffness or 0.0
            felt = EnvironmentEstimator(
                felt,
                robot,
                frame,
                period,
                normal=normal,
                config=fit,
                sliding=_SLIDING,
                reach=0.0 if known > _STIFF else None,
                kept=known if known > _STIFF else math.inf,
            )
    if needs.disturbance == "none":
        return felt
    return MomentumObserver(
        felt,
        robot,
        gain=sensing.noise.observer_gain(robot) if sensing.observer_gain is None else sensing.observer_gain,
        contact=needs.disturbance,
        normal=normal,
        compensation=believed.compensation,
        late_readings=round(believed.sensing_delay / period),
    )


def _filtered(felt: Estimator[Any], robot: Robot, believed: Believed, sensing: SensorFilters) -> Estimator[Any]:
    """The filtered wrench, and the joint torque from its chosen source."""
    frame = believed.presses
    if sensing.torque == "model" and frame is not None:  # before the filter, which would delay τ_ext
        felt = ModelledTorqueEstimator(felt, robot, frame, believed.period)
    if sensing.wrench_cutoff is None:
        return felt
    filter_ = Butterworth(sensing.wrench_cutoff, believed.period)
    if sensing.wrench_stiffness is None or frame is None:
        return FilteredEstimator(felt, wrench=filter_)
    surface = believed.surface or PlaneSurface.facing((0.0, 0.0, 1.0))
    return ComplementaryForce(felt, robot, frame, filter_, sensing.wrench_stiffness, surface)
