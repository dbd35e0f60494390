"""What there is to draw of a run that goes on, or of one that a log holds."""

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
    """The simulated robot in a plant, beneath whatever wraps it; None: there is none."""
    while not isinstance(plant, MujocoPlant) and hasattr(plant, "inner"):
        plant = plant.inner
    return plant if isinstance(plant, MujocoPlant) else None


def drawn_scene(experiment: Experiment) -> DrawnScene:
    """What 3-D views show of a run: robot and scene of a simulation, of any other plant the robot alone."""
    physics, robot = simulated(experiment.plant), experiment.robot
    return DrawnScene(spec_from_robot(robot).compile() if physics is None else physics.model, robot.n)


def drawn_log(log: Log) -> tuple[DrawnScene, Robot, Scene | None]:
    """Model, robot and scene of a logged run; where its study is not here, the robot alone.

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
        pass  # a study or task that is not here, or a log of another version: its configuration is not today's
    robot = Robot.load(info.robot)
    if log["measurement/q"].shape[1] != robot.n:
        joints = log["measurement/q"].shape[1]
        raise RobotError(
            f"{log.source} has {joints} joints, but robot {info.robot!r} has {robot.n}: it cannot be drawn"
        )
    return DrawnScene(spec_from_robot(robot).compile(), robot.n), robot, None
