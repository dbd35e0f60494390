"""Wires the loop of a polishing run."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin

from pliant.errors import ConfigError
from pliant.experiments.model_error import with_mass_error
from pliant.experiments.sensing import sensing_of
from pliant.interfaces import Plant
from pliant.references.postures.inverse_kinematics import Target, joint_box
from pliant.references.postures.posture import mink_solver
from pliant.robot import Robot
from pliant.simulation import ForceSensor, ImperfectPlant, MujocoPlant, Push, Scene, Surface, table
from pliant.simulation.plant import SPEED_STOP
from pliant.simulation.seeding import generator
from pliant.spatial import Array
from pliant.studies.polishing.config import FRAME, PolishingConfig
from pliant.studies.polishing.source import TURNED_DOWN, polishing_source, touching_point
from pliant.studies.polishing.work_config import RepeatedPushes
from pliant.wiring.experiment import Experiment
from pliant.wiring.wire import Offer, wired


def build(config: PolishingConfig) -> Experiment:
    """Robot, plant, estimator, references and controller of one run.

    Raises:
        PliantError: a robot, frame or parameter that does not fit.
    """
    robot = config.robot_model()
    offer = Offer(
        robot=robot,
        model=with_mass_error(robot, config.model_mass_error, generator(config.seed, "model.masses")),
        believed=config.believed,
        plant=lambda felt: plant_of(config, robot),
        source=lambda lookahead: polishing_source(config, robot, lookahead),
        sensing=sensing_of(config.estimation),
        torque_step=config.torque_step,
        joint_limits=config.joint_limits,
    )
    return wired(config.entry, config.parameters(), offer)


def plant_of(config: PolishingConfig, robot: Robot) -> Plant[Any]:
    """The arm over its table, with its imperfections where there are any."""
    surface = Surface(config.table.stiffness, config.table.damping, config.table.friction)
    point = (config.table.x, 0.0, config.table.height)
    start = _start(config, robot)
    physics = MujocoPlant(
        config.robot_model(config.unknown_mass),
        Scene((table(point, config.table.tilt, surface),)),
        period=config.period if config.perfect else config.physics_step,
        physics_step=config.physics_step,
        start=start,
        sensors=[ForceSensor(FRAME)],
        pushes=() if config.pushes is None else _pushes(config.pushes, config),
        observe=[FRAME],
        speed_stop=SPEED_STOP,
    )
    if config.perfect:
        return physics
    holding = np.array(pin.computeGeneralizedGravity(robot.model, robot.model.createData(), start))
    return ImperfectPlant(physics, config.imperfections, seed=config.seed, period=config.period, holding_torque=holding)


def _pushes(pushes: RepeatedPushes, config: PolishingConfig) -> tuple[Push, ...]:
    """Horizontal pushes in random directions until the end of the run."""
    rng = generator(config.seed, "pushes")
    found: list[Push] = []
    time = pushes.start
    while time < config.duration:
        angle = float(rng.uniform(0.0, 2.0 * np.pi))
        force = (pushes.force * float(np.cos(angle)), pushes.force * float(np.sin(angle)), 0.0)
        found.append(Push(pushes.frame, force, time, pushes.duration))
        time += pushes.duration + pushes.gap
    return tuple(found)


def _start(config: PolishingConfig, robot: Robot) -> Array:
    """(n,) rad: the paper's configuration with the tool turned down and lifted, for there it stands in the table.

    Raises:
        ConfigError: the robot cannot take that pose.
    """
    solver = mink_solver(robot, FRAME)
    target = Target(touching_point(config) + np.array([0.0, 0.0, config.task.start]), TURNED_DOWN)
    q = solver.solve(robot.home, robot.home, joint_box(robot), target)
    distance, angle = solver.shortfall(q, target)
    if distance > 1e-3 or angle > 1e-2:
        raise ConfigError(
            f"robot {robot.name!r} must reach {np.round(target.position, 3).tolist()} m with its tool pointing down: it"
            f" misses by {1e3 * distance:.1f} mm and {angle:.2f} rad"
        )
    return q
