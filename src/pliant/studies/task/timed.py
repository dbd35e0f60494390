"""References of a timed list: each target is reached when its phase ends, forces change by their profile, curves begin
at their target, and what is told from the contact counts from where the frame was when it began."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from pliant.errors import ConfigError
from pliant.interfaces import Lookahead
from pliant.references.phases import PhasedSource
from pliant.references.placed_phases import PlacedPhase
from pliant.references.task_phase import TaskPhase
from pliant.references.trajectories.excerpt import Excerpt
from pliant.references.trajectories.rotation import Fixed
from pliant.references.trajectories.trajectory import Blend, Hold, Trajectory
from pliant.references.trajectories.waypoints import Waypoints
from pliant.robot import Robot
from pliant.spatial import Array
from pliant.studies.task.config import TaskCase
from pliant.studies.task.curves import curve_of
from pliant.studies.task.listed import frame_of, placed_phases_of
from pliant.studies.task.phase_axes import axes_of_phases
from pliant.studies.task.pressed import axes_of, turns_of
from pliant.tasks.parts import Pose
from pliant.tasks.phase import Phase


def timed_source(
    case: TaskCase, robot: Robot, start: Array, lookahead: Lookahead | None, in_time: bool = False
) -> PhasedSource:
    """The references.

    Args:
        case: a timed list.
        robot: as it is believed.
        start: (n,) rad.
        lookahead: of a preview; None for none.
        in_time: each phase lasts as long as it may, whatever is felt.

    Raises:
        ConfigError: something that a timed list does not have.
    """
    place, rotation = robot.placement(start, frame_of(case))
    if isinstance(case.start, Pose):  # as it was asked for, not as the solver met it
        place, rotation = np.array(case.start.xyz), case.start.rotation
    all_placed = placed_phases_of(case, robot, rotation)
    phases = _phases(case, all_placed, place, rotation, in_time)
    posture = robot.home if case.start is None or isinstance(case.start, Pose) else start
    return PhasedSource(robot, frame_of(case), phases, rotation, lookahead, posture)


def touching(all_placed: Sequence[PlacedPhase], phases: Sequence[Phase]) -> dict[str, bool]:
    """Name of each phase → whether a force is asked for in it."""
    return {
        placed.name: bool(np.any(placed.task.wrench)) or phase.profile is not None
        for placed, phase in zip(all_placed, phases, strict=True)
    }


def level(all_placed: Sequence[PlacedPhase]) -> bool:
    """Whether everything that is pressed is pressed upwards: then the world's axes are those of the task."""
    pressed = [placed.task.wrench[:3] for placed in all_placed if np.any(placed.task.wrench[:3])]
    return all(wrench[2] > 0.0 and not np.any(wrench[:2]) for wrench in pressed)


def _phases(
    case: TaskCase, all_placed: Sequence[PlacedPhase], place: Array, held: Array, in_time: bool
) -> list[TaskPhase]:
    """Args: place, held: (3,) m and R_world_frame at the start."""
    axes, touches = axes_of_phases(case), touching(all_placed, case.phase)
    flat = level(all_placed) and not axes_of(all_placed, turns_of(all_placed, case.phase, held))
    found: list[TaskPhase] = []
    where = place  # as it is believed
    for index, (placed, phase) in enumerate(zip(all_placed, case.phase, strict=True)):
        R, origin, of_contact = axes[index]
        begin = where if phase.begin is None else origin + R @ np.array(phase.begin)
        places = [begin, *(origin + R @ np.array(one) for one in phase.via), placed.task.position]
        if of_contact:
            places = [one - origin for one in places]
        felt = _waits(phase) and not in_time
        seconds = phase.longest if phase.arrive is None else phase.arrive
        motion = _motion(phase, found, places, R, seconds)
        rotation = placed.task.task_rotation
        found.append(
            TaskPhase(
                placed.name,
                motion,
                "touch" if of_contact else "world",
                _wrench(phase, R, placed.task.wrench),
                math.inf if index + 1 == len(all_placed) else phase.longest,
                ends_on_contact=felt,
                touches=touches[placed.name],
                axes=None if flat or rotation is None else Fixed(rotation),
                patience=phase.longest if felt else math.inf,
                modes=None if phase.modes is None else placed.task.modes,
            )
        )
        where = placed.task.position
    return found


def _motion(phase: Phase, before: Sequence[TaskPhase], places: Sequence[Array], R: Array, seconds: float) -> Trajectory:
    """(3,) m over the time of a phase. Args: places: (3,) m on the way, the last one is the target, reached after
    `seconds`; R: of its frame."""
    curve, target = phase.motion, places[-1]
    if curve is not None and curve.shape == "stop":
        return _stopping(before[-1], curve.ramp)
    if curve is not None and curve.shape != "hold":
        across = R[:, 0] if curve.across is None else R @ np.array(curve.across)
        up = R[:, 1] if curve.up is None else R @ np.array(curve.up)
        moving = curve_of(curve.shape, curve, target, across, up)
        return moving if curve.ramp == 0.0 else moving.eased(curve.ramp)
    if all(np.array_equal(early, late) for early, late in pairwise(places)):
        return Hold(target)
    return Waypoints(np.linspace(0.0, seconds, len(places)), places)


def _stopping(before: TaskPhase, ramp: float) -> Trajectory:
    """The motion of the phase before goes on for a while and comes to rest where half of that would have led."""
    onward = Excerpt(before.motion, before.duration, before.duration + ramp)
    return Blend(onward, Hold(before.motion.at(before.duration + 0.5 * ramp).value), ramp)


def _wrench(phase: Phase, R: Array, held: Array) -> Waypoints | None:
    """(6,) N and N·m in the world over the time of a phase. Args: held: (6,) where it has no profile."""
    if phase.profile is None and phase.press and np.any(held):
        return Waypoints([0.0, phase.press], [np.zeros(6), held], "ramp")
    if phase.profile is None:
        return Waypoints([0.0], held[None], "step") if np.any(held) else None
    told = [(*row, 0.0, 0.0, 0.0)[:6] for row in phase.profile.wrench]
    rows = [np.concatenate([R @ np.array(row[:3]), R @ np.array(row[3:])]) for row in told]
    return Waypoints(phase.profile.times, rows, phase.profile.shape)


def refuse_untimed(case: TaskCase) -> None:
    """Raises ConfigError where a list asks for what only the other kind, timed or not, has."""
    if case.timed:
        if case.event or case.impedance is not None:
            raise ConfigError("a timed list has no events and no impedance of its own: leave out timed = true")
        told = ("limit", "touch")
    else:
        told = ("profile", "begin", "via", "arrive")
    for name, phase in zip(case.phase_names(), case.phase, strict=True):
        said = next((key for key in told if getattr(phase, key) not in (None, ())), None)
        if said is not None and case.timed:
            raise ConfigError(f"phase {name!r}: {said} is not for a timed list: leave it or timed = true out")
        if said is not None:
            raise ConfigError(f"phase {name!r}: {said} is for a timed list: set timed = true, or give targets")
        felt = [one for one in phase.conditions if one.force or one.depth or one.reached or one.contact is False]
        if case.timed and felt:
            raise ConfigError(f"phase {name!r}: a phase of a timed list ends by time or by contact alone")
        if case.timed and _waits(phase) and any(not (one.contact or one.timeout) for one in phase.conditions):
            raise ConfigError(f"phase {name!r}: until = {{ any = [{{ contact = true }}, {{ timeout = … }}] }} alone")
        if case.timed and _waits(phase) and phase.otherwise == "next":
            raise ConfigError(f"phase {name!r}: in a timed list contact that is not felt in time is a failure")
        stops = phase.motion is not None and phase.motion.shape == "stop"
        if stops and not case.timed:
            raise ConfigError(
                f"phase {name!r}: motion.shape = 'stop' is for a timed list: here a curve fades within its `ramp`"
                " when its phase ends"
            )
        if stops and name == case.phase_names()[0]:
            raise ConfigError(f"phase {name!r}: there is no motion before it that could stop")


def _waits(phase: Phase) -> bool:
    """Whether it lasts until contact is felt."""
    return any(one.contact for one in phase.conditions)
