"""Wires the loop of a task that is a list of phases."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pinocchio as pin

from pliant.entries import Believed
from pliant.errors import ConfigError
from pliant.experiments.model_error import with_mass_error
from pliant.experiments.pushes import pushes_of
from pliant.experiments.sensing import sensing_of
from pliant.interfaces import Plant
from pliant.references.placed_phases import PlacedPhase
from pliant.signals import ImpedanceTuning
from pliant.simulation import ForceSensor, Imperfections, ImperfectPlant, JointEffects, LinkCapsule, MujocoPlant
from pliant.simulation.plant import SPEED_STOP
from pliant.simulation.seeding import generator
from pliant.studies.task.config import TaskCase
from pliant.studies.task.landing import landings, too_slow
from pliant.studies.task.limits import refuse_beyond, refuse_outside, run_limits
from pliant.studies.task.list_motion import Listed, source_of
from pliant.studies.task.listed import (
    changes_of,
    frame_of,
    longest_of,
    per_axis,
    placed_phases_of,
    robot_of_list,
    scene_of,
    tracks_of,
)
from pliant.studies.task.pressed import asked_of, axes_of, beside_the_axes, pressed_planes, silent_axes, turns_of
from pliant.studies.task.sensor import known_load, sensor_of
from pliant.studies.task.start import start_of
from pliant.studies.task.timed import level, refuse_untimed, touching
from pliant.studies.task.tracked import tracked_motion
from pliant.studies.task.world import drawn_tool_mass, imperfections_of, inner_period
from pliant.surfaces import SurfaceGeometry
from pliant.telemetry.schema import Channel
from pliant.wiring.estimators import Load
from pliant.wiring.experiment import Experiment
from pliant.wiring.wire import Offer, wired


def listed(case: TaskCase) -> Listed:
    """Robot, belief and parameters of a run. Raises PliantError for what cannot be run."""
    refuse_untimed(case)
    robot, tracking = robot_of_list(case), tracks_of(case)
    if tracking and any(one.change or one.file for one in case.event):
        raise ConfigError("events that change targets or wrenches need phases with a target; tracks take factor alone")
    if tracking:
        frames = tuple(case.phase[0].tracks)
        source = tracked_motion(case)
        believed = _believed(case, frames, oriented=True, presses=None)
        robot = robot if frames[0] == case.tool.frame else robot.with_contact(frames[0], case.tool.radius)
        parameters = case.controller_parameters(robot, believed)
        return Listed(robot, believed, parameters, source.start, longest_of(case), source)
    start = start_of(robot, frame_of(case), case.start)
    all_placed = placed_phases_of(case, robot, robot.placement(start, frame_of(case))[1])
    _refuse(case, all_placed)
    pressing = any(np.any(placed.task.wrench) or "force" in asked_of(placed.task) for placed in all_placed)
    oriented = all(placed.task.rotation is not None for placed in all_placed)
    surface = pressed_planes(all_placed, changes_of(case))
    believed = _believed(case, (frame_of(case),), oriented, frame_of(case) if pressing else None, surface)
    R = robot.placement(start, frame_of(case))[1] if case.timed else None
    turns = turns_of(all_placed, case.phase, R)
    believed = replace(believed, axes=axes_of(all_placed, turns), turns=turns)
    if case.timed:
        if level(all_placed) and not believed.axes:
            surface = None  # nothing is believed of a horizontal one
        believed = replace(believed, oriented=True, surface=surface, phases=touching(all_placed, case.phase))
    parameters = case.controller_parameters(robot, believed)
    gentle = {} if case.timed else landings(case, robot, all_placed, start)
    return Listed(robot, believed, parameters, start, longest_of(case), None, gentle)


def _not_held(case: TaskCase, made: Listed) -> tuple[str, ...]:
    """What phases ask of their axes and the controller does not do, in a sentence."""
    entry = case.entry
    predicts, yields = entry.needs(made.parameters).preview is not None, entry.yields(made.parameters)
    if made.tracked is not None or (yields and not predicts):
        return ()
    R = made.robot.placement(made.start, frame_of(case))[1]
    all_placed, feels = placed_phases_of(case, made.robot, R), entry.needs(made.parameters).wrench
    odd = {
        one.name: beside_the_axes(one, feels=feels, rotation=R if case.timed else None)
        if predicts
        else silent_axes(one)
        for one in all_placed
    }
    told = ", ".join(f"{name!r} ({', '.join(axes)})" for name, axes in odd.items() if axes)
    if not told:
        return ()
    if not predicts:
        return (
            f"controller {case.controller!r} takes 0 N for no request: its impedance holds the axes on which phase"
            f" {told} asks for it; haptic and operational-space yield",
        )
    return (
        f"controller {case.controller!r} weighs positions and forces along the axes of a force: what modes ask beside"
        f" that of phase {told} will not be held; haptic and operational-space hold it",
    )


def _refuse(case: TaskCase, all_placed: Sequence[PlacedPhase]) -> None:
    """Raises ConfigError where targets ask for more than the task's limits allow."""
    forces = [(f"the wrench of phase {one.name!r}", float(np.linalg.norm(one.task.wrench[:3]))) for one in all_placed]
    changes = [change for change in changes_of(case) if change.wrench is not None]
    forces += [("the wrench of an event", float(np.linalg.norm(one.wrench[:3]))) for one in changes]  # type: ignore[index]
    refuse_beyond(case.limits, forces, [] if case.timed else [("planner.speed", case.planner.speed)])
    refuse_outside(case.limits, "a target", np.array([one.task.position for one in all_placed]))


def build_list(case: TaskCase) -> Experiment:
    """Robot, plant, estimator, references and controller of one run.

    Raises:
        PliantError: a robot, frame or parameter that does not fit, or what cannot be run.
    """
    made = listed(case)
    tracking = made.tracked is not None
    frames = made.believed.frames
    late = case.timing.delay > 0.0
    offer = Offer(
        robot=made.robot,
        model=with_mass_error(made.robot, case.truth.link_masses, generator(case.seed, "model.masses")),
        believed=made.believed,
        plant=lambda felt: _plant(case, made, felt),
        source=lambda lookahead: source_of(case, made, lookahead),
        sensing=sensing_of(
            case.estimation,
            felt=not tracking,
            velocity_gain=case.velocity_share,
            joint_memory=None if late or case.timed else 0.0,
            load=_load(case, frames[0]),
        ),
        torque_step=case.torque_step,
        joint_limits=case.joint_limits,
        duration=made.duration,
        limits=run_limits(case.limits, frames[0]),
        warnings=(*_not_held(case, made), *too_slow(case, made.landings)),
        channels=() if tracking or case.timed else (Channel(f"planner/{frames[0]}/clamped", "m"),),
    )
    return wired(case.entry, made.parameters, offer)


def _believed(
    case: TaskCase,
    frames: tuple[str, ...],
    oriented: bool,
    presses: str | None,
    surface: SurfaceGeometry | None = None,
) -> Believed:
    sought = {name: one.touch is not None for name, one in zip(case.phase_names(), case.phase, strict=True)}
    own = case.impedance
    tuning = None if own is None else ImpedanceTuning(*map(per_axis, (own.stiffness, own.force_max, own.range)))
    return Believed(
        frames=frames,
        period=case.simulation.period,
        oriented=oriented,
        presses=presses,
        surface=surface,
        compensation=case.compensates,
        sensing_delay=case.timing.sensing_delay,
        computation_delay=case.timing.computation_delay,
        noise_force=case.estimation.noise_force,
        phases=sought if any(sought.values()) else {},
        tunings={} if tuning is None else {frames[0]: tuning},
    )


def _plant(case: TaskCase, made: Listed, felt: bool) -> Plant[Any]:
    """The robot among its things, with its imperfections where there are any."""
    imperfections, frames = imperfections_of(case), made.believed.frames
    heavier = drawn_tool_mass(case)
    truth = case.truth
    plant = MujocoPlant(
        robot_of_list(case, heavier) if heavier else made.robot,
        scene_of(case),
        period=inner_period(case),
        physics_step=case.simulation.physics_step,
        start=made.start,
        joints=JointEffects(truth.joint_friction, truth.joint_damping, case.compensates),
        sensors=[_sensor(case, frames[0], heavier)] if felt or case.limits.force is not None else [],
        pushes=pushes_of(case.disturbance, case.seed, made.duration),
        links=[LinkCapsule(name, one.to, one.radius, one.margin) for name, one in case.links.items()],
        observe=list(frames),
        speed_stop=SPEED_STOP if case.timed else None,
    )
    if imperfections == Imperfections():
        return plant
    robot = made.robot
    weight = np.array(pin.computeGeneralizedGravity(robot.model, robot.model.createData(), made.start))
    holding = weight if case.compensates == "none" else np.zeros(robot.n)
    return ImperfectPlant(plant, imperfections, seed=case.seed, period=case.simulation.period, holding_torque=holding)


def _sensor(case: TaskCase, frame: str, unknown_mass: float) -> ForceSensor:
    return sensor_of(case, unknown_mass) if frame == case.tool.frame else ForceSensor(frame)


def _load(case: TaskCase, frame: str) -> Load:
    return known_load(case) if frame == case.tool.frame else ({}, {})
