"""How phases come down to what they touch: gently, by what is believed, where the file does not say it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from pliant.references.placed_phases import PlacedPhase
from pliant.references.planners.superposition import MotionLimits
from pliant.references.surface_task import SurfaceTaskSettings
from pliant.references.toolpaths.toolpath import Toolpath
from pliant.rigid_body import mass_along
from pliant.robot import Robot
from pliant.rules import Rule, Suggestion
from pliant.spatial import Array
from pliant.studies.task.config import TaskCase
from pliant.studies.task.pressed import pressed_along
from pliant.tasks.phase import Phase, Thing

_LEAST_WAY = 1e-3  # m towards a contact; what goes less far stays where it is
_SLOWEST = 2e-3  # m/s
_SOURCE = "a mass that meets a spring and a damper, driven on by a loop that is T late; docs/tasks, landing"
_SLOWER = "F / √(k m + k² T²), less where the damper alone would press with F, 2 mm/s at least"
_SPEED = Rule("phase.*.limit.speed", f"{_SLOWER}; F the phase's force, k of what it meets, m of the arm", _SOURCE)
_PRESS = Rule("phase.*.press", "2π √(m / k) + T", _SOURCE)
APPROACH = Rule(
    "phases.approach_speed", f"0.05 m/s, or if that is less {_SLOWER}; F the largest force of the path", _SOURCE
)
RULES = (APPROACH, _SPEED, _PRESS)


class Touch(NamedTuple):
    """A contact as it is believed."""

    stiffness: float
    """k, N/m"""
    damping: float
    """d, N·s/m"""
    transition: float = 0.0
    """s, m of depth over which it fades in"""


@dataclass(frozen=True)
class GentleLanding:
    """What lands gently, and what it follows from."""

    speed: float
    """m/s, largest of the motion along the force"""
    press: float
    """s in which the force is built up from the first contact on"""
    thing: str
    """that is met, as far as is known"""
    stiffness: float
    """N/m, of its contact"""
    mass: float
    """kg, of the frame along the force where the run starts"""
    force: float
    """N, that the landing is to keep to"""
    takes: float
    """s, from where the phase begins to its target at that speed"""


def gentle(touch: Touch, mass: float, late: float, force: float) -> tuple[float, float]:
    """Speed (m/s) and time (s) of a landing that keeps to a force.

    A mass m that meets a spring k at speed v presses with v √(k m) at most. A loop that is late by T may drive on for
    so long, to k v T; a mass that is driven for T and then left alone reaches v √(k m + k² T²). A damper d presses with
    d v at first; where it fades in over a depth s, with ⅔ √(2 m d / (3 s)) v^(3/2) at most. A force that is built up
    evenly within one period of the mass on its spring, 2π √(m / k), leaves that mass at rest; the lateness comes on
    top. This is a rule for a reference, no bound of what a controller does.

    Args:
        touch: of the contact.
        mass: m, kg.
        late: T, s.
        force: N.
    """
    k, d, s = touch.stiffness, touch.damping, touch.transition
    speeds = [force / math.hypot(math.sqrt(k * mass), k * late)]
    if d > 0.0:
        speeds.append(max(force / d, (2.25 * force**2 * 1.5 * s / (mass * d)) ** (1.0 / 3.0)))
    return max(min(speeds), _SLOWEST), 2.0 * math.pi * math.sqrt(mass / k) + late


def approach_speed(case: TaskCase, robot: Robot, path: Toolpath, force: float, start: Array) -> float:
    """m/s, of the approach to a path: what the file says; else the usual one, or what lands gently, if that is less.

    Args:
        case: the task.
        robot: as believed.
        path: on the believed surface.
        force: N, the largest one along the path, that the landing is to keep to.
        start: (n,) rad, at the start of the run.
    """
    if case.phases.approach_speed is not None:
        return case.phases.approach_speed
    normal = path.task.at(0.0).rotation[:, 2]
    mass = mass_along(robot.model, start, robot.frame_id(case.tool.frame), normal)
    late = case.simulation.period + case.timing.delay
    touch = Touch(case.surface.stiffness, case.surface.damping)
    slowest = gentle(touch, mass, late, force)[0] if force > 0.0 else math.inf
    return min(usual_approach(case), slowest)


def usual_approach(case: TaskCase) -> float:
    """m/s, the largest that is chosen where the file says nothing."""
    return min(SurfaceTaskSettings().approach_speed, case.limits.speed or math.inf)


def landings(case: TaskCase, robot: Robot, all_placed: Sequence[PlacedPhase], start: Array) -> dict[str, GentleLanding]:
    """Phase → its gentle landing, for each that goes towards a contact: it asks for a force, and its target lies
    against that from where the phase begins. Args: start: (n,) rad, at the start of the run."""
    if case.landing == "off":
        return {}
    frame, found = all_placed[0].task.frame, dict[str, GentleLanding]()
    place = robot.placement(start, frame)[0]
    late = case.simulation.period + case.timing.delay
    for placed, phase in zip(all_placed, case.phase, strict=True):
        way, place = placed.task.position - place, placed.task.position
        along = pressed_along(placed.task)
        size = float(np.linalg.norm(along))
        force = float(np.linalg.norm(placed.task.wrench[:3])) or case.limits.force
        met = _met(case, phase)
        if met is None or size == 0.0 or force is None or float(way @ along) > -_LEAST_WAY * size:
            continue
        name, thing = met
        mass = mass_along(robot.model, start, robot.frame_id(frame), along / size)
        fades = thing.transition if case.simulation.contact == "explicit" else 0.0
        speed, press = gentle(Touch(thing.stiffness, thing.damping, fades), mass, late, force)
        limits = MotionLimits(case.planner.speed, case.planner.acceleration)
        modes = None if placed.task.modes is None else replace(placed.task.modes, speed=_speed(phase) or speed)
        takes = limits.bounded(modes, way).duration(float(np.linalg.norm(way)))
        found[placed.name] = GentleLanding(speed, press, name, thing.stiffness, mass, force, takes)
    return found


def landed(case: TaskCase, all_placed: Sequence[PlacedPhase], known: Mapping[str, GentleLanding]) -> list[PlacedPhase]:
    """The phases with what the file says of their landing, or what lands gently."""
    both = zip(all_placed, case.phase, strict=True)
    return [_gentle(placed, phase, known.get(placed.name)) for placed, phase in both]


def suggested_landings(case: TaskCase, known: Mapping[str, GentleLanding]) -> dict[str, Suggestion]:
    """Key → what the file leaves to the rule."""
    found: dict[str, Suggestion] = {}
    for name, phase in zip(case.phase_names(), case.phase, strict=True):
        if name in known and _speed(phase) is None:
            found[f"phase.{name}.limit.speed"] = Suggestion(round(known[name].speed, 4), "m/s", _SPEED)
        if name in known and phase.press is None:
            found[f"phase.{name}.press"] = Suggestion(round(known[name].press, 4), "s", _PRESS)
    return found


def told_landing(case: TaskCase, name: str, one: GentleLanding) -> str:
    """What is suggested for a phase and why, in a sentence."""
    phase = case.phase[case.phase_names().index(name)]
    speed = f"at most {1e3 * one.speed:.3g} mm/s" if _speed(phase) is None else "as limit.speed says"
    press = f"within {one.press:.2g} s" if phase.press is None else "as press says"
    return (
        f"phase {name!r} goes {speed} along its force, which is built up {press}: {one.mass:.2g} kg that meet"
        f" {one.thing!r} ({one.stiffness:.3g} N/m) are to press with {one.force:.3g} N at most"
    )


def too_slow(case: TaskCase, known: Mapping[str, GentleLanding]) -> tuple[str, ...]:
    """Phases that end before they can have landed gently at their target, in a sentence each."""
    return tuple(
        f"phase {name!r} may last {phase.longest:.3g} s, and takes {known[name].takes:.3g} s to its target at the"
        f" {1e3 * known[name].speed:.3g} mm/s that land gently: let it last longer, or say limit.speed"
        for name, phase in zip(case.phase_names(), case.phase, strict=True)
        if name in known and _speed(phase) is None and known[name].takes > phase.longest
    )


def _speed(phase: Phase) -> float | None:
    return None if phase.limit is None else phase.limit.speed


def _gentle(placed: PlacedPhase, phase: Phase, landing: GentleLanding | None) -> PlacedPhase:
    press, task = phase.press, placed.task
    if landing is not None:
        press = landing.press if press is None else press
        if task.modes is not None and _speed(phase) is None:
            task = replace(task, modes=replace(task.modes, speed=landing.speed))
    return replace(placed, task=task, press=press or 0.0)


def _met(case: TaskCase, phase: Phase) -> tuple[str, Thing] | None:
    """The thing that a phase says it touches, or else the stiffest that stands around."""
    if phase.touch is not None:
        return phase.touch, case.scene[phase.touch]
    return max(case.scene.items(), key=lambda item: item[1].stiffness, default=None)
