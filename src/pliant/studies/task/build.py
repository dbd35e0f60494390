"""Wires the loop of a task."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np

from pliant.estimation import SurfaceFitConfig
from pliant.experiments.model_error import with_mass_error
from pliant.experiments.sensing import sensing_of
from pliant.interfaces import ReferenceSource
from pliant.references.estimated_surface import CHANNELS, OnEstimatedSurface
from pliant.references.postures.posture import UnreachableError
from pliant.references.surface_task import SurfaceTask, SurfaceTaskSettings, surface_task
from pliant.references.toolpaths.toolpath import Toolpath
from pliant.robot import Robot
from pliant.simulation.seeding import generator
from pliant.studies.task.config import TaskCase
from pliant.studies.task.file_path import slowed
from pliant.studies.task.geometry import force_of, laid_out
from pliant.studies.task.landing import approach_speed, usual_approach
from pliant.studies.task.limits import refuse_beyond, refuse_outside, run_limits
from pliant.studies.task.sensor import known_load
from pliant.studies.task.world import plant_of, true_surface
from pliant.surfaces import SurfaceGeometry
from pliant.tasks.parts import TruthConfig
from pliant.telemetry.schema import Channel
from pliant.wiring.experiment import Experiment
from pliant.wiring.wire import Offer, wired

_REMEDY = "move it by surface.pose or path.at: `pliant task check` of the same task tries which move would help"
_FORCES = 200  # places at which the force of a file is looked at
_SURFACE_CHANNELS = tuple(Channel(name, unit) for name, unit in CHANNELS.items())


@dataclass(frozen=True)
class Planned:
    """What is known of a task before it runs; nothing of `truth` plays a part in it."""

    robot: Robot
    surface: SurfaceGeometry
    """as it is believed"""
    path: Toolpath
    references: SurfaceTask
    approach_speed: float
    """m/s"""


def planned(case: TaskCase) -> Planned:
    """Robot, believed surface, path and phases, with a posture on one branch along all of it.

    Raises:
        PliantError: a robot or path that there is not, or that the robot cannot follow.
    """
    of_the_run = {"truth": TruthConfig(), "seed": 0, "controller": "", "control": {}, "variant": ""}
    believed = case.model_copy(update={**of_the_run, "accept": {}, "sweep": {}, "tune": {}, "description": ""})
    return _planned(believed.model_dump_json())


@lru_cache(maxsize=32)
def _planned(text: str) -> Planned:
    case = TaskCase.model_validate_json(text)
    robot, surface, path = laid_out(case, case.robot)
    refuse_path(case, path)
    phases = case.phases.model_dump(exclude={"approach_speed"})
    usual = case.phases.approach_speed or usual_approach(case)
    settings = SurfaceTaskSettings(**phases, approach_speed=usual, spins=case.path.spins)
    references = _references(case, robot, path, settings)
    speed = approach_speed(case, robot, path, _largest_force(case, path), references.start)
    if speed != usual:
        references = _references(case, robot, path, replace(settings, approach_speed=speed))
    return Planned(robot, surface, path, references, speed)


def _references(case: TaskCase, robot: Robot, path: Toolpath, settings: SurfaceTaskSettings) -> SurfaceTask:
    try:
        return surface_task(robot, case.tool.frame, path, force_of(case), settings, robot.home)
    except UnreachableError as error:
        line = "" if error.place is None else path.told_of(error.place)
        raise UnreachableError(f"{error}{line}; {_REMEDY}", error.time, error.place) from None


def _largest_force(case: TaskCase, path: Toolpath) -> float:
    """N, along the path."""
    if path.force is None:
        return case.force.largest
    return max(float(path.force.at(time).value[0]) for time in np.linspace(0.0, path.duration, _FORCES))


def refuse_path(case: TaskCase, path: Toolpath) -> None:
    """Raises ConfigError where the task asks for more than its limits allow. Rows of a file were refused when the path
    was laid out."""
    speeds = [("phases.approach_speed", case.phases.approach_speed or usual_approach(case))]
    if path.rows is None or not path.rows.paced_by:
        speeds.insert(0, ("path.speed", case.path.speed))
    refuse_beyond(case.limits, [("force.normal", case.force.largest)] if path.force is None else [], speeds)
    refuse_outside(case.limits, "path", path.places + case.tool.tool().reach * path.normals)


def build(case: TaskCase) -> Experiment:
    """Robot, plant, estimator, references and controller of one run.

    Raises:
        PliantError: a robot, frame or parameter that does not fit, or a path that the robot cannot follow.
    """
    made = planned(case)
    robot, believed = made.robot, case.believed(made.surface)
    surface = true_surface(case, made.surface, made.path)
    offer = Offer(
        robot=robot,
        model=with_mass_error(robot, case.truth.link_masses, generator(case.seed, "model.masses")),
        believed=believed,
        plant=lambda felt: plant_of(case, robot, surface, made.references.start, made.references.longest),
        source=lambda ahead: _source(case, made.references.source(ahead)),
        sensing=sensing_of(
            case.estimation, velocity_gain=case.velocity_share, surface=surface_fit(case), load=known_load(case)
        ),
        channels=_SURFACE_CHANNELS if case.force.along == "estimated" else (),
        torque_step=case.torque_step,
        joint_limits=case.joint_limits,
        duration=made.references.longest,
        limits=run_limits(case.limits, case.tool.frame),
        warnings=slowed(case, made.path),
    )
    return wired(case.entry, case.controller_parameters(robot, believed), offer)


def surface_fit(case: TaskCase) -> SurfaceFitConfig | None:
    """How the surface's tilt is estimated; None where the force goes along the believed normal."""
    if case.force.along == "believed":
        return None
    return SurfaceFitConfig(radius=case.tool.tool().reach, stiffness=case.surface.stiffness)


def _source(case: TaskCase, source: ReferenceSource[Any]) -> ReferenceSource[Any]:
    return source if case.force.along == "believed" else OnEstimatedSurface(source, case.tool.frame)
