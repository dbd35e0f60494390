"""The motors' inertia as the joints feel it, in the mass matrix of both models.

A URDF has no field for it, and without it the inertia of an arm's wrist is very small: 3e-4 kg m² instead of 0.07 and
more. The value is the effective inertia at the joint under torque control; with torque feedback it is less than gear² ·
rotor inertia.
"""

from __future__ import annotations

from typing import Annotated, Literal

import numpy as np
import pinocchio as pin
from pydantic import Field

from pliant.errors import ConfigError, options
from pliant.quantity import quantity
from pliant.robots.description import is_revolute
from pliant.robots.known_rotors import PER_ROOT_TORQUE, Rotors
from pliant.spatial import Array

RotorInertia = Annotated[
    Annotated[float, Field(ge=0.0, le=1e3)] | Literal["assumed"] | None,
    quantity(
        ...,
        "kg m²",
        "the motors' inertia seen at every joint; assumed: 0.021 √(torque limit in N·m); none: that of"
        " the catalogue or of the file",
    ),
]
"""a key of configurations"""


def set_rotors(model: pin.Model, rotors: Rotors) -> None:
    """Gives every joint of a model its rotor inertia (kg m²); joints that slide keep theirs, unless all get one number.

    Raises:
        ConfigError: a negative number, another count than the robot has joints, or a rule where a limit is missing.
    """
    if isinstance(rotors, str):
        model.armature = _assumed(model, rotors)
        return
    values = np.broadcast_to(np.asarray(rotors, dtype=np.float64), (model.nv,)) if np.ndim(rotors) == 0 else rotors
    found = np.array(values, dtype=np.float64)
    if found.shape != (model.nv,) or not (np.isfinite(found).all() and (found >= 0.0).all()):
        raise ConfigError(
            f"rotor_inertia must be one number or {model.nv}, kg m², none of them negative, got {rotors!r}"
        )
    model.armature = found


def _assumed(model: pin.Model, rotors: str) -> Array:
    if rotors != "assumed":
        raise ConfigError(f"rotor_inertia must be a number in kg m² or 'assumed'; {options(['assumed'], rotors)}")
    armature = np.array(model.armature)
    for joint in range(1, model.njoints):
        at, name = int(model.joints[joint].idx_v), model.names[joint]
        if not is_revolute(model, joint):
            continue
        limit = float(model.upperEffortLimit[at])
        if not (np.isfinite(limit) and limit > 0.0):
            raise ConfigError(
                f"rotor_inertia 'assumed' follows from the torque limits, and joint {name!r} has none; give kg m²"
            )
        armature[at] = PER_ROOT_TORQUE * np.sqrt(limit)
    return armature
