"""Wires the loop of a stack case."""

from __future__ import annotations

import numpy as np

from pliant.controllers.config import StackConfig as StackParameters
from pliant.controllers.joint_limits import with_joint_limits
from pliant.controllers.profiles import linear_range
from pliant.controllers.step_limit import CHANNELS, StepLimit
from pliant.errors import ConfigError
from pliant.estimation import DirectEstimator
from pliant.experiments.base import Experiment
from pliant.experiments.model_error import with_mass_error
from pliant.references.postures.posture import PostureOptions
from pliant.references.postures.posture_source import PostureSource, posture_source
from pliant.references.retuned import Retuned, TuningChange
from pliant.references.source import FrameMotion
from pliant.references.trajectories.shapes import lemniscate, sine_line
from pliant.references.trajectories.trajectory import Hold
from pliant.robot import Robot
from pliant.signals import ImpedanceTuning
from pliant.simulation import JointEffects, MujocoPlant, Push, Scene, Surface, random_pushes, wall
from pliant.simulation.seeding import generator
from pliant.spatial import frame_with_z_along
from pliant.studies.stack.config import Path, StackConfig
from pliant.telemetry.schema import Channel

TOUCH_RADIUS = 0.01  # m of the sphere with which the tool touches the wall
_CENTRE = (0.0, -0.6, 0.5)  # m, [Stack] sec. III-A
_NOMINAL = (np.pi / 2, 0.75, 0.0, -1.35, 0.0, -0.53, 0.0)  # rad, elbow up, tool along −y


def build(config: StackConfig) -> Experiment:
    """Robot, plant, estimator, references and controller of one run.

    Raises:
        PliantError: a robot, frame or parameter that does not fit.
    """
    rng_pushes, rng_tuning = (np.random.default_rng(seed) for seed in np.random.SeedSequence(config.seed).spawn(2))
    tool, elbow = config.frames()
    robot = Robot.load(config.robot).with_contact(tool, TOUCH_RADIUS)
    robot.frame_id(elbow)
    source = _references(config, robot)
    parameters = config.parameters()
    plant = MujocoPlant(
        robot,
        _scene(config),
        period=config.period,
        physics_step=config.physics_step,
        start=source.start,
        joints=JointEffects(config.joints.friction, config.joints.damping, config.joints.compensation),
        pushes=_pushes(config, rng_pushes),
        observe=[tool, elbow],
    )
    believed = with_mass_error(robot, config.model_mass_error, generator(config.seed, "model.masses"))
    controller = config.entry.build(believed, parameters, config.period)
    channels = tuple(Channel(name, about.unit) for name, about in getattr(controller, "channels", {}).items())
    controller = with_joint_limits(controller, robot, config.joint_limits)
    if config.torque_step is not None:
        controller = StepLimit(controller, robot, config.torque_step)
        channels += tuple(Channel(name, unit) for name, unit in CHANNELS.items())
    return Experiment(
        robot=robot,
        plant=plant,
        estimator=DirectEstimator(velocity_gain=config.joints.velocity_filter),
        source=source if config.retuning is None else Retuned(source, _schedule(config, rng_tuning)),
        controller=controller,
        channels=channels,
        warnings=config.entry.advise(robot, parameters, config.period),
    )


def motion(path: Path, frame: str) -> FrameMotion:
    """What the tool does; its z axis points along −y throughout."""
    if path.kind == "figure8":
        position = lemniscate(period=path.period, centre=_CENTRE)
    elif path.kind == "line":
        position = sine_line(path.amplitude, path.peak_speed, _CENTRE)
    elif path.kind == "stretch":
        # At shoulder height the arm is straight at 0.868 m: the reference goes 10 mm beyond.
        position = sine_line(0.128, 0.2, (0.0, -0.75, 0.31), (0.0, -1.0, 0.0))
    else:
        position = Hold(_CENTRE)
    return FrameMotion(frame, position, frame_with_z_along((0.0, -1.0, 0.0))).eased(path.ramp)


def _references(config: StackConfig, robot: Robot) -> PostureSource:
    tool, elbow = config.frames()
    beyond_reach = config.path.kind == "stretch"
    options = PostureOptions(method=config.path.method, tolerance=np.inf if beyond_reach else 1e-3)
    nominal = _NOMINAL if robot.n == len(_NOMINAL) else None
    return posture_source(robot, motion(config.path, tool), [elbow], config.duration, nominal, options)


def _scene(config: StackConfig) -> Scene:
    if config.wall is None:
        return Scene()
    surface = Surface(config.wall.stiffness, config.wall.damping, config.wall.friction)
    return Scene((wall((config.wall.x + TOUCH_RADIUS, _CENTRE[1], _CENTRE[2]), surface=surface),))


def _pushes(config: StackConfig, rng: np.random.Generator) -> tuple[Push, ...]:
    if config.pushes is None:
        return ()
    return random_pushes(
        rng,
        config.pushes.frame,
        config.duration if config.path.kind != "hold" else 0.6 * config.duration,
        start=config.path.ramp,
        force=config.pushes.force,
        duration=config.pushes.duration,
        gap=config.pushes.gap,
    )


def _schedule(config: StackConfig, rng: np.random.Generator) -> list[TuningChange]:
    """Random factors on stiffness and force of each axis, a few times a second."""
    parameters = config.parameters()
    if config.retuning is None or not isinstance(parameters, StackParameters):
        raise ConfigError(f"only a stack can be retuned, got controller {config.controller!r}")
    low, high = np.log(config.retuning.factor)
    changes: list[TuningChange] = []
    for time in np.arange(config.path.ramp, config.duration, 1.0 / config.retuning.rate):
        for task in parameters.frame_tasks():
            factor = np.exp(rng.uniform(low, high, (2, task.axes)))
            stiffness = task.tuning.stiffness * factor[0]
            bound = np.maximum(task.tuning.force_max * factor[1], stiffness * linear_range(task.tuning))
            tuning = ImpedanceTuning(stiffness, bound, task.tuning.range, task.tuning.linear_range)
            changes.append(TuningChange(float(time), task.frame, tuning))
    return changes
