"""What the task asks at each node of the horizon, readable: the twin of `cpp/mpc/step/horizon.cpp`."""

from __future__ import annotations

import numpy as np

from pliant.errors import ConfigError, SignalError
from pliant.mpc.horizon import HorizonReference
from pliant.signals import Preview, Reference
from pliant.spatial import Array, all_finite

_ROUNDING = 1e-6  # N; a force that is turned to other axes may point into the surface by as much


def along_horizon(reference: Reference, frame: str, horizon: int, dt: float, lead: float = 0.0) -> HorizonReference:
    """The reference at the nodes of a horizon that begins now, or `lead` later.

    A preview is sampled at each node's own time, its phase too, so that a phase switch rolls through the horizon node
    by node. Without a preview the task goes on with its velocity, in its present phase.

    Args:
        reference: of now.
        frame: tracked frame.
        horizon: N.
        dt: s between nodes.
        lead: s from now to the first node.

    Raises:
        SignalError: there is no task for the frame, or a value is not finite.
    """
    if reference.preview is not None:
        found = _sampled(reference.preview, reference.time + lead + dt * np.arange(horizon + 1, dtype=np.float64))
    else:
        found = _extrapolated(reference, frame, lead + dt * np.arange(horizon + 1, dtype=np.float64))
    if not all_finite(
        found.position, found.velocity, found.wrench, *(() if found.rotation is None else (found.rotation,))
    ):
        raise SignalError(f"the reference of frame {frame!r} must be finite")
    return found


def _sampled(preview: Preview, times: Array) -> HorizonReference:
    """Vectors between two samples are interpolated; orientations and phases hold until the next sample."""
    phase = preview.phase or ("",) * len(preview.time)
    if len(preview.time) == len(times) and np.abs(preview.time - times).max() < 1e-9:
        return HorizonReference(
            preview.position,
            preview.rotation,
            preview.velocity,
            preview.wrench,
            preview.posture,
            phase,
            preview.task_rotation,
        )
    at = np.clip(np.searchsorted(preview.time, times + 1e-9, side="right") - 1, 0, len(preview.time) - 1)
    after = np.minimum(at + 1, len(preview.time) - 1)
    span = np.maximum(preview.time[after] - preview.time[at], 1e-12)
    share = np.clip((times - preview.time[at]) / span, 0.0, 1.0)[:, None]

    def between(values: Array) -> Array:
        return values[at] + share * (values[after] - values[at])

    return HorizonReference(
        position=between(preview.position),
        rotation=None if preview.rotation is None else preview.rotation[at],
        velocity=between(preview.velocity),
        wrench=between(preview.wrench),
        posture=None if preview.posture is None else between(preview.posture),
        phase=tuple(phase[index] for index in at),
        task_rotation=None if preview.task_rotation is None else preview.task_rotation[at],
    )


def _extrapolated(reference: Reference, frame: str, elapsed: Array) -> HorizonReference:
    """Args: elapsed: (N+1,) s from now to each node."""
    task = next((task for task in reference.tasks if task.frame == frame), None)
    if task is None:
        got = [task.frame for task in reference.tasks]
        raise SignalError(f"the reference must have a task for frame {frame!r}, it has {got}")
    count = len(elapsed)
    return HorizonReference(
        position=task.position + elapsed[:, None] * task.velocity[:3],
        rotation=None if task.rotation is None else np.tile(task.rotation, (count, 1, 1)),
        velocity=np.tile(task.velocity, (count, 1)),
        wrench=np.tile(task.wrench, (count, 1)),
        posture=None if reference.posture is None else np.tile(reference.posture, (count, 1)),
        phase=(reference.phase,) * count,
        task_rotation=None if task.task_rotation is None else np.tile(task.task_rotation, (count, 1, 1)),
    )


def require_pushing(horizon: HorizonReference, normals: Array) -> None:
    """Refuses a desired force that pulls: a contact can only push.

    Args:
        horizon: with the reference's own wrenches.
        normals: (3,) or (N+1, 3) outward normals of the surface, world axes.

    Raises:
        ConfigError: a desired reaction points into the surface.
    """
    along = np.sum(horizon.wrench[:, :3] * normals, axis=1)
    if along.min() >= -_ROUNDING:
        return
    node = int(np.argmin(along))
    normal = normals if normals.ndim == 1 else normals[node]
    raise ConfigError(
        f"a desired force of {along[node]:.3g} N along the surface's outward normal {np.round(normal, 3).tolist()}"
        " pulls, and a contact can only push: ask for a reaction along the normal, or, where the surface faces the"
        " other way, say so with contact.axes = 'surface' and contact.normal"
    )
