"""What is known of a list of phases before it runs, and the motion that follows from it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from typing import Any

from pliant.entries import Believed, ControllerConfig
from pliant.experiments.drawn_events import tunings_drawn
from pliant.experiments.target_planner import target_planner
from pliant.interfaces import Lookahead, ReferenceSource
from pliant.references.foreseen import Foreseen
from pliant.references.placed_phases import Ending, PhaseChange, PlacedPhases
from pliant.references.planners.curves import CurvedTargets, Planner
from pliant.references.planners.harmonic_planner import HarmonicPlanner, PlannerLimits
from pliant.references.planners.superposition import MotionLimits
from pliant.references.postures.posture_source import PostureSource
from pliant.references.retuned import Retuned
from pliant.robot import Robot
from pliant.signals import ImpedanceTuning
from pliant.spatial import Array
from pliant.studies.task.config import TaskCase
from pliant.studies.task.curves import phase_curves
from pliant.studies.task.landing import GentleLanding, landed
from pliant.studies.task.listed import changes_of, frame_of, longest_of, placed_phases_of
from pliant.studies.task.timed import timed_source


@dataclass(frozen=True)
class Listed:
    """What is known of a list before it runs."""

    robot: Robot
    believed: Believed
    parameters: ControllerConfig
    start: Array
    """(n,) rad"""
    duration: float
    """s"""
    tracked: PostureSource | None
    """where frames are tracked"""
    landings: Mapping[str, GentleLanding] = field(default_factory=dict[str, GentleLanding])
    """phase → how it comes down to what it touches, where the file does not say it"""


def source_of(case: TaskCase, made: Listed, lookahead: Lookahead | None) -> ReferenceSource[Any]:
    """Motion of the frames, with a preview where one is wanted."""
    if made.tracked is not None:
        followed = made.tracked if lookahead is None else Foreseen(made.tracked, lookahead)
        tunings = made.parameters.impedances()
        changes = tunings_drawn(case.event, tunings, case.seed, min(case.duration, longest_of(case)))
        return Retuned(followed, changes) if changes else followed
    if case.timed:
        return timed_source(case, made.robot, made.start, lookahead)
    planner = target_planner(case.planner, case.entry, _wanted(case, made), made.robot, frame_of(case), lookahead)
    return with_curves(case, made, planner)


def with_curves(case: TaskCase, made: Listed, planner: Planner) -> Planner | CurvedTargets:
    """A planner with the curves that phases ask for beside their targets. Raises ConfigError as `phase_curves`."""
    rotation = made.robot.placement(made.start, frame_of(case))[1]
    curves = phase_curves(case, placed_phases_of(case, made.robot, rotation))
    return CurvedTargets(planner, curves) if curves else planner


def planner_in_time(case: TaskCase, made: Listed) -> HarmonicPlanner:
    """Motion through the targets where each phase lasts as long as it may, whatever is felt, and no target is brought
    back into reach."""
    limits = PlannerLimits(linear=MotionLimits(case.planner.speed, case.planner.acceleration))
    return HarmonicPlanner(_wanted(case, made, in_time=True), made.robot.placement, limits, {})


def _wanted(case: TaskCase, made: Listed, in_time: bool = False) -> PlacedPhases:
    robot, frame = made.robot, frame_of(case)
    all_placed = landed(case, placed_phases_of(case, robot, robot.placement(made.start, frame)[1]), made.landings)
    if in_time:
        both = zip(all_placed, case.phase, strict=True)
        all_placed = [replace(placed, endings=(Ending(phase.longest),)) for placed, phase in both]
    tuning = made.parameters.impedances().get(frame, made.believed.tunings.get(frame))
    scaled = tunings_drawn(
        case.event, {} if tuning is None else {frame: tuning}, case.seed, min(case.duration, longest_of(case))
    )
    changes = [PhaseChange(one.time, tuning=_fields(one.tuning)) for one in scaled]
    return PlacedPhases(robot, all_placed, tuning, made.parameters.whole_tuning(), (*changes_of(case), *changes))


def _fields(tuning: ImpedanceTuning) -> dict[str, Array]:
    return {field.name: getattr(tuning, field.name) for field in fields(tuning)}
