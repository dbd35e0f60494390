"""Tilt, stiffness, damping and friction of everything in the scene, as a typed configuration of its own."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from pydantic import BaseModel, ConfigDict

from pliant.live.page.fields import FieldGroup, Path, group_of
from pliant.quantity import quantity
from pliant.simulation import Plane, Scene
from pliant.simulation.scene import Thing
from pliant.spatial import frame_with_z_along, rpy


class SurfaceForm(BaseModel):
    """Contact properties of a thing."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    stiffness: float = quantity(..., "N/m", "force per penetration", shown=(500.0, 5e4), gt=0.0)
    damping: float = quantity(..., "N s/m", "force per speed of penetration", shown=(0.0, 500.0), ge=0.0)
    friction: float = quantity(..., "1", "Coulomb coefficient", shown=(0.0, 1.5), ge=0.0)


class PlaneForm(SurfaceForm):
    """Contact properties and tilt of a surface, relative to the study's scene."""

    tilt: float = quantity(
        0.0, "rad", "tilt about the first tangent axis of the surface", shown=(-0.5, 0.5), ge=-1.5, le=1.5
    )
    turn: float = quantity(0.0, "rad", "tilt about the second tangent axis", shown=(-0.5, 0.5), ge=-1.5, le=1.5)


class SceneForm:
    """The values of a scene, and the scene that follows from changed values.

    Args:
        built: the scene as the study built it.
    """

    def __init__(self, built: Scene) -> None:
        self._built = built
        self.scene = built
        self._values: dict[str, SurfaceForm] = {thing.name: _read(thing) for thing in built.things}

    def group(self) -> FieldGroup:
        """What can be changed: one group per thing."""
        groups = [group_of(values, (name,)) for name, values in self._values.items()]
        return FieldGroup((), "", tuple(groups))

    def changed(self, path: Path, value: Any) -> Scene:
        """The scene with one value changed. Raises ConfigError if the value breaks a rule."""
        from pliant.configuration import merged

        name, key = path
        values = self._values | {name: merged(self._values[name], {key: value})}
        things = tuple(_made(thing, values[thing.name]) for thing in self._built.things)
        scene = replace(self._built, things=things)
        self._values, self.scene = values, scene
        return scene


def _read(thing: Thing) -> SurfaceForm:
    surface = thing.surface
    kind = PlaneForm if isinstance(thing, Plane) else SurfaceForm
    return kind(stiffness=surface.stiffness, damping=surface.damping, friction=surface.friction)


def _made(thing: Thing, values: SurfaceForm) -> Thing:
    moving = thing.surface.friction_moving
    if moving is not None and thing.surface.friction > 0.0:
        moving *= values.friction / thing.surface.friction
    surface = replace(
        thing.surface,
        stiffness=values.stiffness,
        damping=values.damping,
        friction=values.friction,
        friction_moving=moving,
    )
    if isinstance(thing, Plane) and isinstance(values, PlaneForm):
        R = frame_with_z_along(thing.normal) @ rpy(values.tilt, values.turn, 0.0)
        x, y, z = (float(part) for part in np.asarray(R)[:, 2])
        return replace(thing, surface=surface, normal=(x, y, z))
    return replace(thing, surface=surface)
