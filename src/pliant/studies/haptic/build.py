"""Wires the loop of a haptic case."""

from __future__ import annotations

from typing import Any

from pliant.entries import ControllerConfig
from pliant.experiments.model_error import with_masses
from pliant.experiments.sensing import sensing_of
from pliant.experiments.target_planner import target_planner
from pliant.interfaces import Lookahead, Plant, ReferenceSource
from pliant.robot import Robot
from pliant.simulation import ForceSensor, Imperfections, ImperfectPlant, JointEffects, LinkCapsule, MujocoPlant
from pliant.simulation.imperfections.actuation import ActuationConfig
from pliant.simulation.imperfections.sensing import SensingConfig
from pliant.studies.haptic.config import HapticCaseConfig
from pliant.studies.haptic.draws import drawn
from pliant.studies.haptic.safety import warnings_of
from pliant.studies.haptic.scene import scene_of
from pliant.studies.haptic.script import schedule
from pliant.telemetry.channels import Channel
from pliant.wiring.experiment import Experiment
from pliant.wiring.wire import Offer, wired


def build(config: HapticCaseConfig) -> Experiment:
    """Robot, plant, estimator, references and controller of one run.

    Raises:
        PliantError: a robot, frame or parameter that does not fit, or a force that nothing could feel.
    """
    warnings = warnings_of(config, Robot.load(config.robot, locked=config.locked))
    config = drawn(config)
    robot = robot_of(config)
    robot.frame_id(config.frame)
    entry, parameters = config.entry, config.controller_parameters(robot)
    offer = Offer(
        robot=robot,
        believed=config.believed,
        plant=lambda felt: plant_of(config, robot),
        source=lambda lookahead: planned(config, robot, parameters, lookahead),
        sensing=sensing_of(config.estimation, joint_memory=0.0),
        torque_step=config.torque_step,
        joint_limits=config.joint_limits,
        no_force_signal="" if config.sensor or not config.pressing else "set sensor=true, or ask for no force",
        channels=(Channel(f"planner/{config.frame}/clamped", "m"),),
        warnings=warnings,
    )
    return wired(entry, parameters, offer)


def robot_of(config: HapticCaseConfig) -> Robot:
    """The leg, as heavy as the configuration says."""
    robot = Robot.load(config.robot, locked=config.locked, rotor_inertia=config.rotor_inertia)
    if config.hardware.mass_scale is None:
        return robot
    return with_masses(robot, robot.vector(config.hardware.mass_scale, "hardware.mass_scale"))


def planned(
    config: HapticCaseConfig, robot: Robot, parameters: ControllerConfig, lookahead: Lookahead | None = None
) -> ReferenceSource[Any]:
    """What the user wants, planned. The references carry the parameters of the exploration.

    Raises:
        ConfigError: a preview is wanted of the attractor planner, whose way depends on where the robot is.
    """
    wanted = schedule(config, parameters.whole_tuning() or config.exploration)
    return target_planner(config.planner, config.entry, wanted, robot, config.frame, lookahead)


def plant_of(config: HapticCaseConfig, robot: Robot) -> Plant[Any]:
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
