"""A joint path that follows a moving frame, solved before the run and staying on one branch."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from pliant.errors import ConfigError, PliantError, options
from pliant.references.postures.ik_aico import AicoSolver
from pliant.references.postures.inverse_kinematics import JointBox, PoseSolver, Target, joint_box
from pliant.references.source import FrameMotion
from pliant.robot import Robot
from pliant.spatial import Array


def mink_solver(robot: Robot, frame: str) -> PoseSolver:
    """`MinkSolver`, whose module is imported on first use, because mink's solvers take long to import."""
    from pliant.references.postures.ik_mink import MinkSolver

    return MinkSolver(robot, frame)


METHODS: dict[str, Callable[[Robot, str], PoseSolver]] = {"mink": mink_solver, "aico": AicoSolver}
"""name → method"""


class UnreachableError(PliantError):
    """A pose that the robot cannot reach, or not in time.

    Args:
        message: what is said.
        time: s of the motion at which that is.
        place: (3,) m that is not reached; None: it is not one place.
    """

    def __init__(self, message: str, time: float = 0.0, place: Array | None = None) -> None:
        super().__init__(message)
        self.time = time
        self.place = place


@dataclass(frozen=True)
class PostureOptions:
    """How a joint path is solved."""

    method: str = "mink"
    """"mink" (quadratic programs) or "aico" (approximate inference)"""
    period: float = 0.01
    """s between samples; between them the path is a cubic spline"""
    nominal_rate: float = 0.5
    """1/s at which the redundancy drifts towards the nominal posture; 0 leaves it where it is"""
    speed_fraction: float = 1.0
    """share of the joints' speed limits that a step from sample to sample may use"""
    tolerance: float = 1e-3
    """m, tolerance of the position, ten times as many rad of the orientation; infinite accepts the nearest pose"""
    spins: bool = False
    """whether the rotation about the frame's own z axis is free; a suitable one is then chosen"""
    restarts: int = 20
    """random configurations tried for the first pose if neither the nominal posture nor home lead there"""
    repeats: float = 0.0
    """s after which the motion repeats itself, once it has begun; 0: it does not"""


@dataclass(frozen=True)
class PosturePath:
    """A sampled joint path."""

    times: Array
    """(m,) s"""
    postures: Array
    """(m, n) rad"""
    worst_distance: float
    """m, largest position error of the frame"""
    worst_angle: float
    """rad"""
    repeats: float = 0.0
    """s: the path goes on like its last period of this length; 0: its last posture is held"""

    def inside(self, time: float) -> float:
        """The time (s) of the sampled path at which it is as at `time`."""
        if not self.repeats:
            return time
        end = float(self.times[-1]) - _EDGE * float(self.times[1] - self.times[0])
        if time <= end:
            return time
        return end - self.repeats + (time - end) % self.repeats


_BRANCHES = 6  # starts that are tried before a motion is reported as unreachable
_FALLBACK_SPEED = 10.0  # rad/s, for robots whose file has no limit
_AGAIN = 1e-10  # rad between postures a period apart that count as the same
_EDGE = 20  # samples at the end that a path which goes on leaves out: a spline's end is felt less by 0.27 a sample
_AT_REST = 1e-12  # rad a sample: what is left of the drift then, at 0.5/s and 10 ms, is 2e-10 rad


def solve_posture(
    robot: Robot,
    motion: FrameMotion,
    duration: float,
    nominal: npt.ArrayLike | None = None,
    options_: PostureOptions | None = None,
) -> PosturePath:
    """Follows a frame's motion with the whole arm.

    Every sample starts from the one before and may differ from it by no more than the joints' speed allows, so that
    the path stays on one branch. In the null space the arm moves as little as possible and drifts towards the nominal
    posture. While the pose stays the same and that drift has ended, nothing is solved anew. A motion that
    repeats itself is solved until its postures do: then the path goes on like its last period.

    Args:
        robot: the arm.
        motion: what its frame does.
        duration: s to solve for.
        nominal: (n,) rad, where the search starts and the redundancy drifts to; None: the start that was found.
        options_: see `PostureOptions`.

    Raises:
        UnreachableError: with the time, place and size of the error.
        ConfigError: an unknown method or an impossible duration.
    """
    chosen = options_ or PostureOptions()
    solver = _make_solver(robot, motion.frame, chosen)
    if not (math.isfinite(duration) and duration > 0.0):
        raise ConfigError(f"a posture path needs a duration above 0 s, got {duration}")
    preferred = None if nominal is None else robot.vector(nominal, "the nominal posture")
    times = np.linspace(0.0, duration, max(4, math.ceil(duration / chosen.period) + 1))
    failure: UnreachableError | None = None
    for start in first_postures(solver, _target(motion, 0.0, chosen), preferred, chosen)[:_BRANCHES]:
        try:
            return _follow(solver, motion, times, start, start if preferred is None else preferred, chosen)
        except UnreachableError as error:
            failure = failure or error  # of the best branch
    assert failure is not None
    raise failure


def _make_solver(robot: Robot, frame: str, chosen: PostureOptions) -> PoseSolver:
    if chosen.method not in METHODS:
        raise ConfigError(f"no method {chosen.method!r} for inverse kinematics; {options(METHODS, chosen.method)}")
    for name in ("period", "speed_fraction", "tolerance"):
        if not getattr(chosen, name) > 0.0:
            raise ConfigError(f"{name} of a posture path must be above zero, got {getattr(chosen, name)}")
    return METHODS[chosen.method](robot, frame)


def first_postures(solver: PoseSolver, target: Target, nominal: Array | None, chosen: PostureOptions) -> list[Array]:
    """Configurations (n,) that reach a pose, the best one first.

    The best is the nearest to the nominal posture if there is one, otherwise the one farthest from joint limits and
    singularities.

    Raises:
        UnreachableError: none was found; with the error of the nearest one.
    """
    robot, box = solver.robot, joint_box(solver.robot)
    random = np.random.default_rng(0)
    guesses = [robot.home] if nominal is None else [nominal, robot.home]
    guesses += [
        random.uniform(np.maximum(box.lower, -math.pi), np.minimum(box.upper, math.pi)) for _ in range(chosen.restarts)
    ]
    found: list[Array] = []
    best, least = guesses[0], math.inf
    for guess in guesses:
        q = guess
        for _ in range(3):  # the prior is updated, so that the posture cost vanishes
            q = solver.solve(q, q, box, target)
        distance, angle = solver.shortfall(q, target)
        if distance <= chosen.tolerance and angle <= 10.0 * chosen.tolerance:
            found.append(q)
        elif distance + 0.1 * angle < least:
            best, least = q, distance + 0.1 * angle
    if not found:
        raise UnreachableError(_complaint(solver, best, target, 0.0), place=target.position)
    if nominal is not None:
        return sorted(found, key=lambda q: float(np.linalg.norm(q - nominal)))
    return sorted(found, key=lambda q: -freedom(solver, box, q))


def freedom(solver: PoseSolver, box: JointBox, q: Array) -> float:
    """Least joint range left, as a share of the half range, times the least singular value of the frame's Jacobian."""
    margin = float(np.min(np.minimum(q - box.lower, box.upper - q) / (box.upper - box.lower))) * 2.0
    return margin * float(np.linalg.svd(solver.jacobian(q), compute_uv=False)[-1])


def _follow(
    solver: PoseSolver, motion: FrameMotion, times: Array, start: Array, preferred: Array, chosen: PostureOptions
) -> PosturePath:
    speed = np.minimum(solver.robot.velocity_limit, _FALLBACK_SPEED) * chosen.speed_fraction
    limits = joint_box(solver.robot)
    postures = np.empty((times.shape[0], solver.robot.n))
    postures[0] = q = start
    period = float(times[1] - times[0])
    drift = min(1.0, chosen.nominal_rate * period)
    held, rests = _target(motion, 0.0, chosen), False
    worst = solver.shortfall(q, held)
    again, alike = _samples(chosen.repeats, period), 0
    for index in range(1, times.shape[0]):
        target = _target(motion, float(times[index]), chosen)
        same, held = _same(target, held), target
        if same and rests:
            postures[index] = q
            continue
        reach = JointBox(np.maximum(limits.lower, q - speed * period), np.minimum(limits.upper, q + speed * period))
        q = solver.solve(q, q + drift * (preferred - q), reach, target)
        short = solver.shortfall(q, target)
        if short[0] > chosen.tolerance or short[1] > 10.0 * chosen.tolerance:
            hurried = float(np.max(np.abs(q - postures[index - 1]) / speed)) > 0.999 * period
            when = float(times[index])
            raise UnreachableError(_complaint(solver, q, target, when, hurried), when, target.position)
        worst = (max(worst[0], short[0]), max(worst[1], short[1]))
        rests = same and float(np.max(np.abs(q - postures[index - 1]))) <= _AT_REST
        postures[index] = q
        alike = alike + 1 if 0 < again <= index and np.abs(q - postures[index - again]).max() <= _AGAIN else 0
        if alike == again + _EDGE:
            return PosturePath(times[: index + 1], postures[: index + 1].copy(), *worst, chosen.repeats)
    return PosturePath(times, postures, worst[0], worst[1])


def _samples(seconds: float, period: float) -> int:
    """Samples in a span of time; 0 where they are not a whole number."""
    count = round(seconds / period)
    return count if abs(count * period - seconds) <= 1e-9 else 0


def _target(motion: FrameMotion, time: float, chosen: PostureOptions) -> Target:
    task = motion.at(time)
    return Target(task.position, task.rotation, chosen.spins)


def _same(one: Target, other: Target) -> bool:
    if one.rotation is None or other.rotation is None:
        turned = one.rotation is other.rotation
    else:
        turned = np.array_equal(one.rotation, other.rotation)
    return turned and np.array_equal(one.position, other.position)


def _complaint(solver: PoseSolver, q: Array, target: Target, time: float, hurried: bool = False) -> str:
    distance, angle = solver.shortfall(q, target)
    where = ", ".join(f"{x:.3f}" for x in target.position)
    reason = "in time: a joint is at its speed limit, so slow the motion down" if hurried else "at all"
    return (
        f"frame {solver.frame!r} of robot {solver.robot.name!r} cannot reach ({where}) m at t = {time:.3f} s {reason};"
        f" it stays {1e3 * distance:.1f} mm and {math.degrees(angle):.1f}° short"
    )
