"""Fixes joints of a model; the bodies behind them keep their inertia."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pinocchio as pin

from pliant.errors import ConfigError, options
from pliant.spatial import Array


def lock(
    name: str, model: pin.Model, visual: pin.GeometryModel | None, home: Array, joints: Mapping[str, float]
) -> tuple[pin.Model, pin.GeometryModel | None, Array]:
    """Fixes joints at given angles.

    Args:
        name: of the robot, for messages.
        model: the robot.
        visual: its shapes.
        home: (n,) its home.
        joints: joint → rad or m.

    Returns:
        Model, shapes and home of the robot that is left.

    Raises:
        ConfigError: a joint that the robot does not have, an angle that is not finite, or nothing left to move.
    """
    names = list(model.names)[1:]
    for joint, value in joints.items():
        if joint not in names:
            raise ConfigError(
                f"robot {name!r} has no joint {joint!r} to lock; {options(names, joint)}; locked={{}} locks none"
            )
        if not np.isfinite(value):
            raise ConfigError(f"joint {joint!r} must be locked at a finite angle, got {value}")
    if len(joints) >= len(names):
        raise ConfigError(f"robot {name!r} has {len(names)} joints, locking {len(joints)} leaves none to move")
    q = np.array(home)
    for joint, value in joints.items():
        q[names.index(joint)] = value
    ids = [model.getJointId(joint) for joint in joints]
    left = home[[i for i, joint in enumerate(names) if joint not in joints]]
    if visual is None:
        return _reparented(model, pin.buildReducedModel(model, ids, q)), None, left
    reduced, shapes = pin.buildReducedModel(model, visual, ids, q)
    return _reparented(model, reduced), shapes, left


def _reparented(before: pin.Model, after: pin.Model) -> pin.Model:
    """pinocchio makes the frame of a locked joint its own parent: it gets the parent that it had."""
    for index in range(1, after.nframes):
        frame = after.frames[index]
        if int(frame.parentFrame) == index:
            above = before.frames[before.frames[before.getFrameId(frame.name)].parentFrame].name
            frame.parentFrame = after.getFrameId(above)
    return after
