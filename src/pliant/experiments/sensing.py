"""`SensorFilters` from the configuration of a study or a task."""

from __future__ import annotations

from pliant.estimation import SurfaceFitConfig
from pliant.tasks.estimation import Estimation
from pliant.wiring.estimators import Load, SensorFilters
from pliant.wiring.noise import Noise


def noise_of(keys: Estimation) -> Noise:
    """As it is assumed."""
    return Noise(keys.noise_position, keys.noise_velocity, keys.noise_force)


def sensing_of(
    keys: Estimation,
    *,
    felt: bool = True,
    velocity_gain: float = 1.0,
    joint_memory: float | None = None,
    surface: SurfaceFitConfig | None = None,
    load: Load = ({}, {}),
) -> SensorFilters:
    """For the wiring. Args: keys; those of `SensorFilters`; load: carried, contact_frames; joint_memory: of a task."""
    return SensorFilters(
        felt=felt,
        velocity_gain=velocity_gain,
        wrench_cutoff=keys.wrench_cutoff,
        wrench_stiffness=keys.wrench_stiffness,
        torque=keys.torque,
        joint_memory=joint_memory if keys.joint_memory is None else keys.joint_memory,
        observer_gain=keys.observer_gain,
        noise=noise_of(keys),
        acceleration_cutoff=keys.acceleration_cutoff,
        changing=keys.changing,
        tare=keys.tare,
        surface=surface,
        carried=load[0],
        contact_frames=load[1],
    )
