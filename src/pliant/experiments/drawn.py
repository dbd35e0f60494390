"""Robot and scene to draw, of a running experiment or of a log."""

from __future__ import annotations

from typing import Any

from pliant.configuration import validated
from pliant.errors import PliantError, RobotError
from pliant.experiments.base import Experiment
from pliant.experiments.registry import get_study
from pliant.mujoco_model import spec_from_robot
from pliant.robot import Robot
from pliant.simulation import MujocoPlant, Scene
from pliant.telemetry.log import Log
from pliant.telemetry.scene_topics import DrawnScene


def simulated(plant: Any) -> MujocoPlant | None:
    """The simulated robot inside a plant and its wrappers; None: there is none."""
    while not isinstance(plant, MujocoPlant) and hasattr(plant, "inner"):
        plant = plant.inner
    return plant if isinstance(plant, MujocoPlant) else None


def drawn_scene(experiment: Experiment) -> DrawnScene:
    """The scene for 3-D views of a run: robot and scene of a simulation; for other plants the robot alone."""
    physics, robot = simulated(experiment.plant), experiment.robot
    return DrawnScene(spec_from_robot(robot).compile() if physics is None else physics.model, robot.n)


def drawn_log(log: Log) -> tuple[DrawnScene, Robot, Scene | None]:
    """Model, robot and scene of a logged run; where its study is not available, the robot alone.

    Raises:
        RobotError: the robot of the log is not here, or has other joints.
    """
    info = log.info
    try:
        study = get_study(info.study)
        built = study.build(validated(study.config_type, info.config))
        physics = simulated(built.plant)
        if physics is not None:
            return DrawnScene(physics.model, built.robot.n), built.robot, physics.scene
    except PliantError:
        pass  # the study or task is not available, or the log is of a version with another configuration
    robot = Robot.load(info.robot)
    if log["measurement/q"].shape[1] != robot.n:
        joints = log["measurement/q"].shape[1]
        raise RobotError(
            f"{log.source} has {joints} joints, but robot {info.robot!r} has {robot.n}: it cannot be drawn"
        )
    return DrawnScene(spec_from_robot(robot).compile(), robot.n), robot, None
