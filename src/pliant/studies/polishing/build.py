"""Wires the loop of a polishing run."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pinocchio as pin

from pliant.controllers.joint_limits import with_joint_limits
from pliant.errors import ConfigError
from pliant.estimation import (
    Butterworth,
    EnvironmentEstimator,
    FilteredEstimator,
    FitConfig,
    JointStateFilter,
    MomentumObserver,
    WrenchEstimator,
)
from pliant.experiments.base import Experiment
from pliant.experiments.model_error import with_mass_error
from pliant.interfaces import Controller, Estimator, Plant
from pliant.mpc import MpcConfig, MpcController
from pliant.references.phases import Lookahead
from pliant.references.postures.ik_mink import MinkSolver
from pliant.references.postures.inverse_kinematics import Target, joint_box
from pliant.robot import Robot, Tool
from pliant.simulation import ForceSensor, ImperfectPlant, MujocoPlant, Push, Scene, Surface, table
from pliant.simulation.seeding import generator
from pliant.spatial import Array
from pliant.studies.polishing.config import BALL_RADIUS, FRAME, PolishingConfig, Pushes
from pliant.studies.polishing.source import TURNED_DOWN, polishing_source, touching_point
from pliant.telemetry.schema import Channel

SPEED_STOP = 2.0
"""multiple of the joints' speed limits at which the robot stops and the run counts as failed"""
_JOINT_MEMORY = 0.3  # s
_SLIDING = 0.02  # m/s; faster than that, an unknown tilt looks like a soft table


def build(config: PolishingConfig) -> Experiment:
    """Robot, plant, estimator, references and controller of one run.

    Raises:
        PliantError: a robot, frame or parameter that does not fit.
    """
    robot = robot_of(config)
    parameters = config.parameters()
    believed = with_mass_error(robot, config.model_mass_error, generator(config.seed, "model.masses"))
    controller: Controller[Any] = config.entry.build(believed, parameters, config.period)
    channels: Mapping[str, Any] = getattr(controller, "channels", {})
    lookahead = Lookahead(parameters.horizon, parameters.dt, lead_of(controller))
    return Experiment(
        robot=robot,
        plant=plant_of(config, robot),
        estimator=estimator_of(config, believed, parameters),
        source=polishing_source(config, robot, lookahead),
        controller=with_joint_limits(controller, robot, config.joint_limits),
        channels=tuple(Channel(name, about.unit) for name, about in channels.items()),
        warnings=config.entry.advise(robot, parameters, config.period),
    )


def lead_of(controller: Controller[Any]) -> float:
    """s from now to the effect of the controller's command, as far as it knows."""
    return controller.compensator.lead if isinstance(controller, MpcController) else 0.0


def robot_of(config: PolishingConfig, unknown_mass: float = 0.0) -> Robot:
    """The arm with its tool; the real tool may be heavier than the known one."""
    tool = Tool(frame=FRAME)
    heavier = Tool(frame=FRAME, mass=tool.mass + unknown_mass)
    return Robot.load(config.robot, locked=config.locked, tool=heavier).with_contact(FRAME, BALL_RADIUS)


def plant_of(config: PolishingConfig, robot: Robot) -> Plant[Any]:
    """The arm over its table, with its imperfections where there are any."""
    surface = Surface(config.table.stiffness, config.table.damping, config.table.friction)
    point = (config.table.x, 0.0, config.table.height)
    start = _start(config, robot)
    physics = MujocoPlant(
        robot_of(config, config.unknown_mass),
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


def estimator_of(config: PolishingConfig, robot: Robot, parameters: MpcConfig) -> Estimator[Any]:
    """What the controller needs: the contact wrench always, a disturbance and an environment where it asks for them."""
    wanted, settings = parameters.compensation, config.estimation
    estimator: Estimator[Any] = WrenchEstimator(robot)
    if settings.wrench_cutoff is not None:
        estimator = FilteredEstimator(estimator, wrench=Butterworth(settings.wrench_cutoff, config.period))
    memory = settings.joint_memory
    if memory is None:
        memory = _JOINT_MEMORY if wanted.any else 0.0
    if memory > 0.0:
        estimator = JointStateFilter(estimator, memory)
    if wanted.environment:
        fit = FitConfig(cutoff=30.0)
        estimator = EnvironmentEstimator(estimator, robot, FRAME, config.period, config=fit, sliding=_SLIDING)
    if wanted.disturbance:
        late = round(config.imperfections.sensing.delay / config.period)
        explained = "normal" if parameters.contact.dimension == 1 else "all"
        gain = settings.observer_gain
        estimator = MomentumObserver(estimator, robot, gain=gain, contact=explained, late_readings=late)
    return estimator


def _pushes(pushes: Pushes, config: PolishingConfig) -> tuple[Push, ...]:
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
    solver = MinkSolver(robot, FRAME)
    target = Target(touching_point(config) + np.array([0.0, 0.0, config.task.start]), TURNED_DOWN)
    q = solver.solve(robot.home, robot.home, joint_box(robot), target)
    distance, angle = solver.shortfall(q, target)
    if distance > 1e-3 or angle > 1e-2:
        raise ConfigError(
            f"robot {robot.name!r} must reach {np.round(target.position, 3).tolist()} m with its tool pointing down: it"
            f" misses by {1e3 * distance:.1f} mm and {angle:.2f} rad"
        )
    return q
