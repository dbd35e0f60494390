"""The true world of a task: surface, robot, pushes."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pinocchio as pin

from pliant.configuration import merged
from pliant.errors import ConfigError, options
from pliant.experiments.pushes import pushes_of
from pliant.interfaces import Plant
from pliant.references.toolpaths.toolpath import Toolpath
from pliant.robot import Robot
from pliant.simulation import Imperfections, ImperfectPlant, JointEffects, MujocoPlant, Scene, SurfaceChange
from pliant.simulation import Surface as Touch
from pliant.simulation.plant import SPEED_STOP
from pliant.simulation.scene import fixed_part
from pliant.simulation.seeding import generator
from pliant.spatial import Array, unit
from pliant.studies.task.config import TaskCase
from pliant.studies.task.geometry import robot_of
from pliant.studies.task.sensor import sensor_of
from pliant.surfaces import SurfaceGeometry
from pliant.tasks.along import AlongSurface
from pliant.tasks.draws import Drawn, drawn

_IMPERFECTIONS = {
    "none": Imperfections(),
    "p3": Imperfections.p3(),
    "p3-without-torque-loop": Imperfections.p3(pid=False),
}


@dataclass(frozen=True)
class TrueSurface:
    """The part of one run."""

    geometry: SurfaceGeometry
    touch: Touch


def true_surface(case: TaskCase, believed: SurfaceGeometry, path: Toolpath) -> TrueSurface:
    """The surface of a run: shifted along the normal and tilted about the first contact, as its seed draws."""
    truth = case.truth
    pivot, normal = path.places[0], path.normals[0]
    axis = generator(case.seed, "truth.axis").standard_normal(3) if truth.axis == "random" else np.array(truth.axis)
    if truth.axis == "random":
        axis = axis - normal * float(axis @ normal)
    axis = unit(axis, "truth.axis")
    shift = _draw(case, "shift", truth.shift) * normal
    turn = math.radians(_draw(case, "tilt", truth.tilt)) * axis
    moved = believed.moved(shift, turn, pivot)
    return TrueSurface(moved, feel_of(case, moved))


def feel_of(case: TaskCase, geometry: SurfaceGeometry) -> Touch:
    """Contact properties of the true surface, drawn by the seed or along an axis of its frame.

    Raises:
        ConfigError: stiffness and damping that change along two different axes.
    """
    truth, changing = case.truth, dict[str, AlongSurface]()
    drawn_ones = ("stiffness", "damping", "friction")
    feel = {name: float(getattr(case.surface, name)) for name in (*drawn_ones, "transition")}
    for name in drawn_ones:
        value = getattr(truth, name)
        if isinstance(value, AlongSurface):
            changing[name] = value
        elif value is not None:
            feel[name] = max(_draw(case, name, value), 0.0)
    same = Touch(feel["stiffness"], feel["damping"], feel["friction"], transition=feel["transition"])
    if not changing:
        return same
    axes = {value.along for value in changing.values()}
    if len(axes) > 1:
        raise ConfigError(f"truth.stiffness and truth.damping change along one axis, got {sorted(axes)}")
    places = sorted({place for value in changing.values() for place in value.places})
    at = {
        name: np.interp(places, changing[name].places, changing[name].numbers)
        if name in changing
        else np.full(len(places), feel[name])
        for name in ("stiffness", "damping")
    }
    o, d = geometry.origin.tolist(), geometry.rotation[:, "xyz".index(axes.pop())].tolist()
    K, D = (tuple(map(float, at[name])) for name in ("stiffness", "damping"))
    change = SurfaceChange((o[0], o[1], o[2]), (d[0], d[1], d[2]), tuple(places), K, D)
    return replace(same, stiffness=K[0], damping=D[0], change=change)


def imperfections_of(case: TaskCase) -> Imperfections:
    """Of sensors, drives and computation. Raises ConfigError: values that there are not."""
    wanted = case.truth.imperfections
    changes = dict(wanted) if isinstance(wanted, dict) else {"base": wanted}
    base = changes.pop("base", "none")
    if base not in _IMPERFECTIONS:
        raise ConfigError(f"truth.imperfections.base: {options(_IMPERFECTIONS, str(base))}, got {base!r}")
    found = merged(_IMPERFECTIONS[base], changes)
    if found == Imperfections():
        return found  # damped joints are the plant's own
    damping = case.truth.joint_damping
    return found.model_copy(update={"joint_damping": damping}) if damping else found


def plant_of(case: TaskCase, robot: Robot, surface: TrueSurface, start: Array, seconds: float) -> Plant[Any]:
    """The robot over the part, with its imperfections where there are any."""
    tool = case.tool.frame
    imperfections = imperfections_of(case)
    heavier = drawn_tool_mass(case)
    physics = MujocoPlant(
        robot_of(case, case.robot, heavier) if heavier else robot,
        Scene((fixed_part("part", surface.geometry, surface.touch),), case.simulation.contact),
        period=inner_period(case),
        physics_step=case.simulation.physics_step,
        start=start,
        joints=JointEffects(case.truth.joint_friction, case.truth.joint_damping, case.compensates),
        sensors=[sensor_of(case, heavier)],
        pushes=pushes_of(case.disturbance, case.seed, seconds),
        observe=[tool],
        speed_stop=SPEED_STOP,
    )
    if imperfections == Imperfections():
        return physics
    weight = np.array(pin.computeGeneralizedGravity(robot.model, robot.model.createData(), start))
    holding = weight if case.compensates == "none" else np.zeros(robot.n)
    return ImperfectPlant(physics, imperfections, seed=case.seed, period=case.simulation.period, holding_torque=holding)


def inner_period(case: TaskCase) -> float:
    """s: a perfect robot is stepped once a control period; drives and gears act inside of it."""
    if imperfections_of(case) == Imperfections():
        return case.simulation.period
    return case.simulation.drive_step or case.simulation.physics_step


def drawn_tool_mass(case: TaskCase) -> float:
    """kg of the real tool beside what is known."""
    return _draw(case, "tool_mass", case.truth.tool_mass)


def _draw(case: TaskCase, name: str, value: Drawn) -> float:
    return drawn(value, generator(case.seed, f"truth.{name}"))
