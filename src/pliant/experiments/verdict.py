"""General criteria by which a run that reached its end still counts as failed."""

from __future__ import annotations

import math

import numpy as np

from pliant.compiled import Rows
from pliant.estimation import start_hints
from pliant.robot import Robot
from pliant.signals import Tick
from pliant.spatial import Array
from pliant.telemetry import in_parts
from pliant.telemetry.log import Log

LIMIT_TOLERANCE = math.radians(1.0)
"""rad by which a joint may exceed its limit; twice the deflection of a stop under the joint's full torque"""
LIMIT_TOLERANCE_LINEAR = 2e-3
"""m, of joints that slide"""


def physical_verdict(log: Log, robot: Robot) -> str | None:
    """The reason why a simulated run is a failure in any study or task, in one sentence; None if it is not.

    - A joint passed its position limit by more than a tolerance.
    - A frame was asked for a force and no part of the robot ever touched anything.

    Args:
        log: of the run; without `truth/…` the result is None.
        robot: that ran.
    """
    found = [text for text in (_limit_passed(log, robot), _never_touched(log)) if text is not None]
    return "; ".join(found) or None


class StartNotes:
    """An observer of the first tick, which adds start hints to the warnings of the run."""

    def __init__(self) -> None:
        self.sentences: tuple[str, ...] | None = None

    def __call__(self, tick: Tick) -> None:
        if self.sentences is None:
            free = tick.truth is None or not any(np.any(wrench) for wrench in tick.truth.wrenches.values())
            self.sentences = start_hints(tick.estimate) if free else ()

    def take_block(self, rows: Rows) -> None:
        if self.sentences is None:
            self(rows.first())


def _limit_passed(log: Log, robot: Robot) -> str | None:
    if "truth/limit_excess" not in log:
        return None
    name = "truth/limit_excess"
    slides = _slides(robot)
    tolerance = np.where(slides, LIMIT_TOLERANCE_LINEAR, LIMIT_TOLERANCE)
    most = in_parts.largest(np.max(part, axis=0) for (part,) in log.parts(name))
    joint = int(np.argmax(most / tolerance))
    if not most[joint] > tolerance[joint]:
        return None
    worst = float(most[joint])
    size, allowed = (
        (f"{1e3 * worst:.1f} mm", f"{1e3 * LIMIT_TOLERANCE_LINEAR:g} mm")
        if slides[joint]
        else (f"{math.degrees(worst):.1f}°", f"{math.degrees(LIMIT_TOLERANCE):g}°")
    )
    beyond = np.concatenate([part[:, joint] > tolerance[joint] for (part,) in log.parts(name)])
    since = float(log.time(name)[int(np.argmax(beyond))])
    return (
        f"joint limit passed: {robot.joint_names[joint]} by {size}, first at t = {since:.2f} s (more than {allowed}"
        " beyond a limit is not a success)"
    )


def _never_touched(log: Log) -> str | None:
    names = log.matching("/wrench")
    felt = [name for name in names if name.startswith("truth/")]
    if not felt or any(np.any(part[:, :3]) for name in felt for (part,) in log.parts(name)):
        return None
    for name in names:
        if not name.startswith("reference/"):
            continue
        asked = float(in_parts.largest(np.linalg.norm(part[:, :3], axis=1).max() for (part,) in log.parts(name)))
        if asked > 0.0:
            frame = name.removeprefix("reference/").removesuffix("/wrench")
            return f"no contact: frame {frame} should press with {asked:.3g} N and the robot touched nothing"
    return None


def _slides(robot: Robot) -> Array:
    """(n,) which joints slide."""
    kinds = [joint.shortname() for joint in list(robot.model.joints)[1:]]
    return np.array([kind.startswith("JointModelP") for kind in kinds])
