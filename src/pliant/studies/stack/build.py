"""Wires the loop of a stack case."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from typing import Any

from pliant.errors import ConfigError
from pliant.experiments.drawn_events import tunings_drawn
from pliant.experiments.model_error import with_mass_error
from pliant.experiments.pushes import pushes_of
from pliant.experiments.sensing import sensing_of
from pliant.interfaces import Lookahead, ReferenceSource
from pliant.references.foreseen import Foreseen
from pliant.references.postures.posture_source import PostureSource
from pliant.references.retuned import Retuned, TuningChange
from pliant.robot import Robot
from pliant.simulation import ForceSensor, JointEffects, MujocoPlant, Push, Scene, Surface, wall
from pliant.simulation.seeding import generator
from pliant.studies.stack.config import GainChanges, StackCaseConfig, StackPath
from pliant.studies.stack.paper_task import TOUCH_RADIUS
from pliant.studies.stack.placement import Placement, placed
from pliant.tasks.draws import LogUniform, Uniform
from pliant.tasks.events import Event, Scaled
from pliant.tasks.parts import Disturbance
from pliant.wiring.experiment import Experiment
from pliant.wiring.wire import Offer, wired


def build(config: StackCaseConfig) -> Experiment:
    """Robot, plant, estimator, references and controller of one run.

    Raises:
        PliantError: a robot, frame or parameter that does not fit.
    """
    tool, elbow = config.frames()
    place, source = _placed(config)
    robot = config.robot_model().with_contact(tool, TOUCH_RADIUS)
    robot = replace(robot, notes=(*robot.notes, *((place.told,) if place.told else ())))
    offer = Offer(
        model=with_mass_error(robot, config.model_mass_error, generator(config.seed, "model.masses")),
        robot=robot,
        believed=replace(config.believed, frames=(tool, elbow)),
        plant=lambda felt: MujocoPlant(
            robot,
            _scene(config, place),
            period=config.period,
            physics_step=config.physics_step,
            start=source.start,
            joints=JointEffects(config.joints.friction, config.joints.damping, config.joints.compensation),
            sensors=[ForceSensor(tool)] if felt else [],
            pushes=_pushes(config),
            observe=[tool, elbow],
        ),
        source=lambda lookahead: _changed(_foreseen(source, lookahead), config),
        sensing=sensing_of(
            config.estimation, felt=False, velocity_gain=config.joints.velocity_filter, joint_memory=0.0
        ),
        torque_step=config.torque_step,
        joint_limits=config.joint_limits,
    )
    return wired(config.entry, config.parameters(), offer)


def _foreseen(source: PostureSource, lookahead: Lookahead | None) -> ReferenceSource[Any]:
    return source if lookahead is None else Foreseen(source, lookahead)


def _changed(source: ReferenceSource[Any], config: StackCaseConfig) -> ReferenceSource[Any]:
    return source if config.retuning is None else Retuned(source, _schedule(config, config.retuning))


def place_of(config: StackCaseConfig) -> Placement:
    """Where the path of a run lies. Raises UnreachableError where the robot can follow it nowhere."""
    return _placed(config)[0]


def _placed(config: StackCaseConfig) -> tuple[Placement, PostureSource]:
    """Found once for all runs of the same robot and path: the inverse kinematics takes seconds."""
    locked = None if config.locked is None else tuple(sorted(config.locked.items()))
    return _found(config.robot, locked, config.path.model_dump_json(), config.frames(), config.duration)


@lru_cache(maxsize=8)
def _found(
    robot: str, locked: tuple[tuple[str, float], ...] | None, path: str, frames: tuple[str, str], duration: float
) -> tuple[Placement, PostureSource]:
    arm = Robot.load(robot, locked=None if locked is None else dict(locked))
    return placed(arm, StackPath.model_validate_json(path), frames, duration)


def _scene(config: StackCaseConfig, place: Placement) -> Scene:
    if config.wall is None:
        return Scene()
    surface = Surface(config.wall.stiffness, config.wall.damping, config.wall.friction)
    across = place.axes[:, 0]
    x, y, z = (place.centre + (place.scale * config.wall.x + TOUCH_RADIUS) * across).tolist()
    nx, ny, nz = (-across).tolist()
    return Scene((wall((x, y, z), (nx, ny, nz), surface=surface),))


def _pushes(config: StackCaseConfig) -> tuple[Push, ...]:
    if config.pushes is None:
        return ()
    pushes = config.pushes
    disturbance = Disturbance(
        frame=pushes.frame,
        push=Uniform(uniform=pushes.force),
        start=config.path.ramp,
        duration=Uniform(uniform=pushes.duration),
        gap=Uniform(uniform=pushes.gap),
        end=pushes.end,
    )
    return pushes_of([disturbance], config.seed, config.duration)


def _schedule(config: StackCaseConfig, changes: GainChanges) -> list[TuningChange]:
    """Random factors on stiffness and force of each axis, a few times a second."""
    tunings = config.parameters().impedances()
    if not tunings:
        raise ConfigError(f"only impedances can be retuned, controller {config.controller!r} has none")
    names: tuple[Scaled, ...] = ("stiffness", "force_max", "range", "linear_range")
    scaled = names if changes.ranges else names[:2]
    event = Event(
        time=config.path.ramp,
        every=1.0 / changes.rate,
        factor={name: LogUniform(log_uniform=changes.factor) for name in scaled},
    )
    return tunings_drawn([event], tunings, config.seed, config.duration)
