"""Wires the loop of a haptic case."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pinocchio as pin

from pliant.controllers.attractor import Law
from pliant.controllers.joint_limits import with_joint_limits
from pliant.controllers.stack import Stack
from pliant.controllers.task import FrameTask
from pliant.errors import ConfigError
from pliant.estimation import WrenchEstimator
from pliant.experiments.base import Experiment
from pliant.interfaces import Plant, ReferenceSource
from pliant.references.exploration.config import ExplorationConfig
from pliant.references.exploration.haptic_exploration import CHANNELS, HapticExploration
from pliant.references.planners.attractor_planner import AttractorPlanner
from pliant.references.planners.harmonic_attractor import AttractorSettings
from pliant.references.planners.harmonic_planner import HarmonicPlanner, PlannerLimits
from pliant.references.planners.superposition import MotionLimits
from pliant.references.planners.workspace import workspace_of
from pliant.robot import Robot
from pliant.simulation import ForceSensor, Imperfections, ImperfectPlant, JointEffects, LinkCapsule, MujocoPlant
from pliant.simulation.imperfections.actuation import ActuationConfig
from pliant.simulation.imperfections.sensing import SensingConfig
from pliant.studies.haptic.config import HapticConfig, Planner
from pliant.studies.haptic.draws import drawn
from pliant.studies.haptic.safety import warnings_of
from pliant.studies.haptic.scene import scene_of
from pliant.studies.haptic.script import schedule
from pliant.telemetry.schema import Channel

TASK = "foot"
"""label of the impedance in channel names"""


def build(config: HapticConfig) -> Experiment:
    """Robot, plant, estimator, references and controller of one run.

    Raises:
        PliantError: a robot, frame or parameter that does not fit, or a force that nothing could feel.
    """
    warnings = warnings_of(config, Robot.load(config.robot))
    config = drawn(config)
    robot = robot_of(config)
    robot.frame_id(config.frame)
    _require_force_signal(config)
    controller = foot_impedance(robot, config)
    units = [Channel(name, about.unit) for name, about in controller.channels.items()]
    units.append(Channel(f"planner/{config.frame}/clamped", "m"))
    units += [Channel(f"exploration/{config.frame}/{name}", unit) for name, unit in CHANNELS.items()]
    return Experiment(
        robot=robot,
        plant=plant_of(config, robot),
        estimator=WrenchEstimator(robot),
        source=references(config, robot),
        controller=with_joint_limits(controller, robot, config.joint_limits),
        channels=tuple(units),
        warnings=warnings,
    )


def robot_of(config: HapticConfig) -> Robot:
    """The leg, as heavy as the configuration says."""
    robot = Robot.load(config.robot)
    if config.hardware.mass_scale is None:
        return robot
    factors = robot.vector(config.hardware.mass_scale, "hardware.mass_scale")
    model = robot.model.copy()
    for joint, factor in enumerate(factors, start=1):
        body = model.inertias[joint]
        model.inertias[joint] = pin.Inertia(factor * body.mass, body.lever, factor * body.inertia)
    return replace(robot, model=model)


def foot_impedance(robot: Robot, config: HapticConfig) -> Stack:
    """The fractal impedance that pulls the foot."""
    printed = config.controller == "haptic-paper"
    law = Law.HAPFIC if printed else config.impedance.law
    task = FrameTask(config.frame, config.impedance.tuning(), TASK, config.impedance.profile)
    return Stack(robot, [task], config.period, law=law)


def references(config: HapticConfig, robot: Robot) -> ReferenceSource[Any]:
    """What the user wants, planned, and then explored."""
    exploration = effective_exploration(config)
    wanted = schedule(config, exploration)
    planned = _planned(wanted, config.planner, robot, config.frame, printed=config.controller == "haptic-paper")
    return planned if config.controller == "haptic-hold" else HapticExploration(planned, exploration)


def effective_exploration(config: HapticConfig) -> ExplorationConfig:
    """The exploration's parameters; as printed for the control arm."""
    if config.controller == "haptic-paper":
        return config.exploration.model_copy(update={"mode": "paper"})
    return config.exploration


def plant_of(config: HapticConfig, robot: Robot) -> Plant[Any]:
    """The leg in its environment, with its imperfections where there are any."""
    hardware, environment = config.hardware, config.environment
    links = [LinkCapsule("shank", config.frame, 0.02, end_margin=0.04)] if environment.shank else []
    plant = MujocoPlant(
        robot,
        scene_of(environment),
        period=config.period,
        physics_step=config.physics_step,
        start=config.start,
        joints=JointEffects(damping=hardware.joint_damping, compensation=hardware.compensation),
        sensors=[ForceSensor(config.frame)] if config.sensor else [],
        links=links,
        observe=[config.frame],
    )
    if hardware.perfect:
        return plant
    imperfections = Imperfections(
        computation_delay=hardware.command_delay,
        joint_damping=hardware.joint_damping,
        actuation=ActuationConfig(bandwidth=hardware.bandwidth, peak_torque=hardware.peak_torque),
        sensing=SensingConfig(noise_force=hardware.force_noise, delay_force=hardware.force_delay),
    )
    if config.period != imperfections.torque_loop.period:
        loop = imperfections.torque_loop.model_copy(update={"period": config.period})
        imperfections = imperfections.model_copy(update={"torque_loop": loop})
    return ImperfectPlant(plant, imperfections, seed=config.seed)


def _planned(
    wanted: ReferenceSource[Any], planner: Planner, robot: Robot, frame: str, printed: bool
) -> ReferenceSource[Any]:
    if printed or planner.kind == "attractor":
        # as printed, eq. 3 gets stuck or runs away and nothing else could be compared: the corrected reading
        return AttractorPlanner(wanted, robot.placement, AttractorSettings(planner.speed, planner.acceleration))
    limits = PlannerLimits(linear=MotionLimits(planner.speed, planner.acceleration))
    return HarmonicPlanner(wanted, robot.placement, limits, {frame: workspace_of(robot, frame)})


def _require_force_signal(config: HapticConfig) -> None:
    pressing = any(step.force is not None and any(step.force) for step in config.steps)
    if pressing and not config.sensor and config.controller != "haptic-hold":
        raise ConfigError(
            f"frame {config.frame!r} should press but has no force signal: set sensor=true, ask for no force, or use"
            " controller haptic-hold"
        )
