"""The things of a scene as they really are: moved, tilted and made of something else, as the seed draws."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import pinocchio as pin

from pliant.errors import ConfigError, options
from pliant.simulation.seeding import generator
from pliant.spatial import exp3, unit
from pliant.studies.task.config import TaskCase
from pliant.tasks.draws import Drawn, drawn
from pliant.tasks.parts import Pose
from pliant.tasks.phase import Thing
from pliant.tasks.thing_truth import ThingTruth

_FEEL = ("stiffness", "damping", "friction", "mass")


def true_scene(case: TaskCase) -> Mapping[str, Thing]:
    """Name → thing. Raises ConfigError where `truth.things` names none of the scene, or gives a mass to a fixed one."""
    found = dict(case.scene)
    for name, truth in case.truth.things.items():
        if name not in found:
            raise ConfigError(f"truth.things: there is no thing {name!r} in the scene; {options(found, name)}")
        if truth.mass is not None and found[name].mass == 0.0:
            raise ConfigError(f"truth.things.{name}.mass: the thing is fixed to the world, its mass is believed as 0")
        found[name] = _true(case, name, found[name], truth)
    return found


def _true(case: TaskCase, name: str, believed: Thing, truth: ThingTruth) -> Thing:
    def draw(what: str, value: Drawn) -> float:
        return drawn(value, generator(case.seed, f"truth.things.{name}.{what}"))

    R, place = believed.pose.rotation, np.array(believed.pose.xyz)
    axis = np.array([*generator(case.seed, f"truth.things.{name}.axis").standard_normal(2), 0.0])
    if truth.axis != "random":
        axis = np.array(truth.axis)
    turn = math.radians(draw("tilt", truth.tilt)) * unit(axis, f"truth.things.{name}.axis")
    shift = [draw(f"shift.{label}", value) for label, value in zip("xyz", truth.shift, strict=True)]
    rpy = np.degrees(pin.rpy.matrixToRpy(R @ exp3(turn)))
    told: dict[str, Any] = {
        what: max(draw(what, value), 0.0) for what in _FEEL if (value := getattr(truth, what)) is not None
    }
    changes = {"pose": Pose(xyz=tuple(place + R @ shift), rpy=tuple(rpy.tolist())), **told}
    return Thing.model_validate({**believed.model_dump(), **changes})
