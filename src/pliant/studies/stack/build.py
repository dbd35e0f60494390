"""Wires the loop of a stack case."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from pliant.controllers.profiles import linear_range
from pliant.errors import ConfigError
from pliant.experiments.model_error import with_mass_error
from pliant.interfaces import Lookahead, ReferenceSource
from pliant.references.foreseen import Foreseen
from pliant.references.postures.posture import PostureOptions
from pliant.references.postures.posture_source import PostureSource, posture_source
from pliant.references.retuned import Retuned, TuningChange
from pliant.references.source import FrameMotion
from pliant.references.trajectories.shapes import lemniscate, sine_line
from pliant.references.trajectories.trajectory import Hold
from pliant.robot import Robot
from pliant.signals import ImpedanceTuning
from pliant.simulation import ForceSensor, JointEffects, MujocoPlant, Push, Scene, Surface, random_pushes, wall
from pliant.simulation.seeding import generator
from pliant.spatial import frame_with_z_along
from pliant.studies.stack.config import Path, StackConfig
from pliant.wiring.estimators import Sensing
from pliant.wiring.experiment import Experiment
from pliant.wiring.wire import Offer, wired

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
    offer = Offer(
        model=with_mass_error(robot, config.model_mass_error, generator(config.seed, "model.masses")),
        robot=robot,
        believed=replace(config.believed, frames=(tool, elbow)),
        plant=lambda felt: MujocoPlant(
            robot,
            _scene(config),
            period=config.period,
            physics_step=config.physics_step,
            start=source.start,
            joints=JointEffects(config.joints.friction, config.joints.damping, config.joints.compensation),
            sensors=[ForceSensor(tool)] if felt else [],
            pushes=_pushes(config, rng_pushes),
            observe=[tool, elbow],
        ),
        source=lambda lookahead: _changed(_foreseen(source, lookahead), config, rng_tuning),
        sensing=Sensing(felt=False, velocity_gain=config.joints.velocity_filter, joint_memory=0.0),
        torque_step=config.torque_step,
        joint_limits=config.joint_limits,
    )
    return wired(config.entry, config.parameters(), offer)


def _foreseen(source: PostureSource, lookahead: Lookahead | None) -> ReferenceSource[Any]:
    return source if lookahead is None else Foreseen(source, lookahead)


def _changed(source: ReferenceSource[Any], config: StackConfig, rng: np.random.Generator) -> ReferenceSource[Any]:
    return source if config.retuning is None else Retuned(source, _schedule(config, rng))


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
    tunings = config.parameters().impedances()
    if config.retuning is None or not tunings:
        raise ConfigError(f"only impedances can be retuned, controller {config.controller!r} has none")
    low, high = np.log(config.retuning.factor)
    changes: list[TuningChange] = []
    for time in np.arange(config.path.ramp, config.duration, 1.0 / config.retuning.rate):
        for frame, now in tunings.items():
            factor = np.exp(rng.uniform(low, high, (2, now.axes)))
            stiffness = now.stiffness * factor[0]
            bound = np.maximum(now.force_max * factor[1], stiffness * linear_range(now))
            tuning = ImpedanceTuning(stiffness, bound, now.range, now.linear_range)
            changes.append(TuningChange(float(time), frame, tuning))
    return changes
