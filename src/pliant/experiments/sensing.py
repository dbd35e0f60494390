"""The wiring's `Sensing`, from the keys of a study or a task."""

from __future__ import annotations

from pliant.estimation import SurfaceFitConfig
from pliant.tasks.estimation import Estimation
from pliant.wiring.estimators import Load, Sensing


def sensing_of(
    keys: Estimation,
    *,
    felt: bool = True,
    velocity_gain: float = 1.0,
    joint_memory: float | None = None,
    surface: SurfaceFitConfig | None = None,
    load: Load = ({}, {}),
) -> Sensing:
    """For the wiring. Args: keys; those of `Sensing`; load: carried and contact_frames; joint_memory: of the task."""
    return Sensing(
        felt=felt,
        velocity_gain=velocity_gain,
        wrench_cutoff=keys.wrench_cutoff,
        joint_memory=joint_memory if keys.joint_memory is None else keys.joint_memory,
        observer_gain=keys.observer_gain,
        acceleration_cutoff=keys.acceleration_cutoff,
        tare=keys.tare,
        surface=surface,
        carried=load[0],
        contact_frames=load[1],
    )
