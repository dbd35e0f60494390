"""Configurations of an arm that are most informative for the identification of its tool with a force/torque sensor."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from pliant.errors import ConfigError
from pliant.estimation.tool_identification import CONDITION_LIMIT, LEAST_POSES, excitation
from pliant.robot import Robot
from pliant.spatial import Array, skew

POSES, JOINTS, SHARE = 8, 3, 0.8
"""default number of poses, number of the last joints that move, and share of their range"""
_CANDIDATES = 400
_REGULAR = 0.25  # least share of the home's smallest singular value that a pose and the way to it may have


def identification_poses(
    robot: Robot,
    sensor_frame: str,
    n: int = POSES,
    *,
    joints: int = JOINTS,
    share: float = SHARE,
    lowest: float | None = None,
    seed: int = 0,
) -> Array:
    """Chooses n configurations (n, robot.n), rad, starting at home, in an order that moves little from one to the next.

    Only the last joints move, so that the arm stays near its home. Obstacles are not known here: check the poses before
    running them. Poses beyond a singularity are left out, because task-space controllers would have to pass through it.
    Among random candidates each pose is the one that adds most to the information about m c and the moment bias
    (D-optimal, one at a time).

    Args:
        robot: with its joint limits and home.
        sensor_frame: where the sensor sits.
        n: number of poses.
        joints: how many of the last joints move.
        share: of each joint's range that is used, about its middle.
        lowest: m, no candidate puts the sensor below this height; None: 0.1 m below its height at home.
        seed: of the candidates.

    Raises:
        ConfigError: too few poses, a share outside (0, 1], or joints that cannot turn the sensor enough.
        RobotError: a frame that the robot does not have.
    """
    if n < LEAST_POSES:
        raise ConfigError(f"identifying a tool takes at least {LEAST_POSES} poses, got {n}")
    if not 0.0 < share <= 1.0:
        raise ConfigError(f"the share of the joints' range must lie within (0, 1], got {share}")
    if not 1 <= joints <= robot.n:
        raise ConfigError(f"between 1 and {robot.n} joints of robot {robot.name!r} can move, got {joints}")
    floor = robot.placement(robot.home, sensor_frame)[0][2] - 0.1 if lowest is None else lowest
    postures, rotations = _candidates(robot, sensor_frame, joints, share, floor, seed)
    chosen = _most_informative(np.einsum("nji,j->ni", rotations, [0.0, 0.0, -1.0]), n)
    condition = excitation(rotations[chosen])
    if condition > CONDITION_LIMIT:
        raise ConfigError(
            f"moving the last {joints} joints of robot {robot.name!r} over {share:g} of their range does not turn"
            f" {sensor_frame!r} enough (condition number {condition:.3g}, at most {CONDITION_LIMIT:g}): let more joints"
            " move, use more of their range, or allow a lower height"
        )
    return postures[_short_tour(postures, chosen)]


def _candidates(robot: Robot, frame: str, joints: int, share: float, floor: float, seed: int) -> tuple[Array, Array]:
    """Postures (m, n), home first, and R_world_sensor (m, 3, 3)."""
    data, index = robot.model.createData(), robot.frame_id(frame)
    moving = np.arange(robot.n) >= robot.n - joints
    # a joint without limits turns by up to half a turn to each side
    middle = np.clip(0.5 * (robot.position_lower + robot.position_upper), -np.pi, np.pi)
    half = np.minimum(0.5 * (robot.position_upper - robot.position_lower), np.pi) * share
    draws = middle + half * np.random.default_rng(seed).uniform(-1.0, 1.0, (_CANDIDATES, robot.n))
    regular = _REGULAR * _smallest_singular_value(robot, data, robot.home, index)
    postures: list[Array] = []
    rotations: list[Array] = []
    for q in [robot.home, *np.where(moving, draws, robot.home)]:
        way = np.linspace(robot.home, q, 17)[1:]
        least = min(_smallest_singular_value(robot, data, point, index) for point in way)
        pin.framesForwardKinematics(robot.model, data, q)
        if not postures or (data.oMf[index].translation[2] >= floor and least >= regular):
            postures.append(q)
            rotations.append(np.array(data.oMf[index].rotation))
    return np.array(postures), np.array(rotations)


def _smallest_singular_value(robot: Robot, data: pin.Data, q: Array, index: int) -> float:
    """Least singular value of the frame's Jacobian, of its linear part where the robot has fewer than six joints."""
    J = pin.computeFrameJacobian(robot.model, data, q, index, pin.ReferenceFrame.LOCAL_WORLD_ALIGNED)
    rows = J if robot.n >= 6 else J[:3]
    return float(np.linalg.svd(rows, compute_uv=False)[-1])


def _most_informative(g: Array, n: int) -> list[int]:
    """Indices of n directions of gravity (m, 3), the first one given, each next one raising log det most."""
    blocks = np.array([np.column_stack([-skew(row), np.eye(3)]) for row in g])  # (m, 3, 6)
    gains = np.einsum("mki,mkj->mij", blocks, blocks)
    chosen, information = [0], gains[0] + 1e-6 * np.eye(6)
    while len(chosen) < n:
        score = np.linalg.slogdet(information + gains)[1]
        score[chosen] = -np.inf
        best = int(np.argmax(score))
        chosen.append(best)
        information = information + gains[best]
    return chosen


def _short_tour(postures: Array, chosen: list[int]) -> list[int]:
    """The same indices, each followed by its nearest neighbour that is left."""
    tour, left = [chosen[0]], chosen[1:]
    while left:
        nearest = min(left, key=lambda i: float(np.max(np.abs(postures[i] - postures[tour[-1]]))))
        tour.append(nearest)
        left.remove(nearest)
    return tour
