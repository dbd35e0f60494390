"""Robot, believed surface and path of a task."""

from __future__ import annotations

import itertools
import math

import numpy as np

from pliant.errors import ConfigError, UnknownFrameError
from pliant.experiments.model_error import with_masses
from pliant.references.postures.inverse_kinematics import Target, joint_box
from pliant.references.postures.posture import freedom, mink_solver
from pliant.references.toolpaths.patterns import PATTERNS
from pliant.references.toolpaths.pressing import PressingForce
from pliant.references.toolpaths.toolpath import PathMotion, Toolpath, on_chart, resting
from pliant.robot import Robot
from pliant.robots.chain import arm_of
from pliant.spatial import Array, exp3, unit
from pliant.studies.task.file_path import path_from_file
from pliant.surfaces import SurfaceGeometry
from pliant.tasks.parts import PathConfig, Pose
from pliant.tasks.task import TaskParts

_FORWARD = (0.5, 0.6, 0.7, 0.8, 0.9)  # of the arm's reach: where a place for a part is looked for
_HEIGHT = (0.07, 0.28, 0.5)  # of that reach, over the base
_NEARER = ((0.2, 0.3, 0.4, 0.5), (-0.15, 0.0, 0.07, 0.28))  # the same for an arm that is short beside its tool
_AROUND = (-0.05, 0.0, 0.05)  # m, before and behind a place, where the tool must do as well
_LONGEST = 200.0  # m of a pattern
_UPRIGHT = 5  # joints that it takes to hold a tool upright at a place
WITHOUT_FLANGE = (
    'a leg presses with a frame of its own, in a task of phases with moves = "foot" (`pliant list tasks`: floor, ball)'
)
"""what to do with a robot that cannot hold a tool upright on a surface"""


def robot_of(task: TaskParts, source: str, unknown_mass: float = 0.0) -> Robot:
    """The robot with its tool. Args: unknown_mass: kg of the real tool beside the known ones.

    Raises:
        PliantError: a robot, joint or frame that there is not.
    """
    made = task.tool.tool(unknown_mass)
    locked = None if task.locked is None else {joint: math.radians(angle) for joint, angle in task.locked.items()}
    try:
        arm = Robot.load(source, locked=locked, tool=made, rotor_inertia=task.rotor_inertia)
    except UnknownFrameError as error:
        raise UnknownFrameError(f"the tool of this task is held at tool.parent: {error}; {WITHOUT_FLANGE}") from None
    return weighed(task, arm.touching_with(made))


def weighed(task: TaskParts, robot: Robot) -> Robot:
    """The robot with its links as heavy as the task says."""
    return robot if task.mass_scale is None else with_masses(robot, robot.vector(task.mass_scale, "mass_scale"))


def laid_out(task: TaskParts, source: str) -> tuple[Robot, SurfaceGeometry, Toolpath]:
    """Robot, believed surface and the path on it. Raises PliantError: one that there is not."""
    robot = robot_of(task, source)
    surface = believed_surface(task, robot)
    return robot, surface, toolpath_of(task, surface, robot)


def believed_surface(task: TaskParts, robot: Robot) -> SurfaceGeometry:
    """Where the controller believes the surface."""
    return task.surface.geometry(task.surface.pose or default_pose(task, robot))


def default_pose(task: TaskParts, robot: Robot) -> Pose:
    """A place in front of the robot, turned by `surface.tilt` about the world's y axis: there the tool, upright on the
    surface, is farthest from joint limits and singularities, on the branch of home.

    A cylinder lies across, along the y axis; its top, like that of other parts, is where a plane would be.
    """
    if task.surface.shape in ("mesh", "hole", "edge"):
        turned = task.surface.geometry(Pose(rpy=(0.0, task.surface.tilt, 0.0)))
        top = turned.top()
        at = good_place(robot, task.tool.frame, turned.normal(top), turned.curvatures(top)[0])
        return Pose(xyz=_three(at - top), rpy=(0.0, task.surface.tilt, 0.0))
    tilt = math.radians(task.surface.tilt)
    normal = np.array([math.sin(tilt), 0.0, math.cos(tilt)])
    curvature = 0.0 if task.surface.shape == "plane" else (-1.0 if task.surface.hollow else 1.0) / task.surface.radius
    at = good_place(robot, task.tool.frame, normal, curvature)
    if task.surface.shape == "plane":
        return Pose(xyz=_three(at), rpy=(0.0, task.surface.tilt, 0.0))
    side = -1.0 if task.surface.hollow else 1.0
    middle = at - side * task.surface.radius * normal
    turned = (90.0, 0.0, 0.0) if task.surface.shape == "cylinder" else (0.0, task.surface.tilt, 0.0)
    return Pose(xyz=_three(middle), rpy=turned)


def good_place(robot: Robot, frame: str, normal: Array, curvature: float) -> Array:
    """(3,) m before the robot where a frame whose z axis goes into a surface has most freedom, and around it too.

    Args:
        robot: that is to reach it.
        frame: of the tool.
        normal: (3,) of the surface at the place.
        curvature: 1/m, by which the normal turns before and behind the place; positive where the solid is convex.

    Raises:
        ConfigError: there is none.
    """
    home = robot.placement(robot.home, frame)[0]
    ahead = math.atan2(float(home[1]), float(home[0])) if math.hypot(home[0], home[1]) > 0.05 else 0.0
    arm = arm_of(robot.model)
    if arm is None:
        raise ConfigError(f"robot {robot.name!r} forks at its base: say where the part stands by surface.pose")
    length = arm.reach
    solver, box = mink_solver(robot, frame), joint_box(robot)
    direction = np.array([math.cos(ahead), math.sin(ahead), 0.0])

    def free(at: Array, step: float) -> float:
        turned = math.cos(curvature * step) * normal + math.sin(curvature * step) * direction
        n = unit(turned, "a normal")
        x = _heading(robot, frame, n)
        q, target = robot.home, Target(at + step * direction, np.column_stack([x, np.cross(-n, x), -n]))
        for _ in range(3):  # the prior moves along, so that the posture cost stops pulling
            q = solver.solve(q, q, box, target)
        distance, angle = solver.shortfall(q, target)
        return freedom(solver, box, q) if distance < 1e-3 and angle < 1e-2 else 0.0

    for shares, heights in ((_FORWARD, _HEIGHT), _NEARER):
        best, most = None, 0.0
        for share, height in itertools.product(shares, heights):
            at = length * (share * direction + np.array([0.0, 0.0, height]))
            least = math.inf
            for step in _AROUND:
                least = min(least, free(at, step))
                if least <= most:
                    break  # another place is better, whatever is found around this one
            else:
                best, most = at, least
        if best is not None:
            return best
    raise ConfigError(
        f"no place was found before robot {robot.name!r} where its tool can stand upright on the surface: give one by"
        " surface.pose, for example surface.pose.xyz=[0.5,0,0.1]"
        + (f"; {WITHOUT_FLANGE}" if robot.n < _UPRIGHT else "")
    )


def toolpath_of(task: TaskParts, surface: SurfaceGeometry, robot: Robot) -> Toolpath:
    """The path on the believed surface, oriented and timed.

    Raises:
        ConfigError: a file that cannot be read or leaves the surface, or a path without length.
    """
    path = task.path
    motion = PathMotion(
        path.speed,
        path.acceleration,
        math.radians(path.tool_tilt),
        math.radians(path.tool_lean),
        task.tool.tool().reach,
    )
    near = surface.near(surface.top() if path.at is None else np.array(path.at))
    along, across = _axes(task, surface, near.point, near.normal)
    heading = _heading(robot, task.tool.frame, near.normal)
    if path.pattern == "hold":
        return resting(near.point, near.normal, path.time, motion, heading)
    if path.file is None:
        _check_length(path)
        uv = PATTERNS[path.pattern](path.size, path.spacing, path.turns)
        return on_chart(surface, near.point, along, uv, motion, heading)
    return path_from_file(task, surface, near.point, (along, across, near.normal), motion, heading)


def force_of(task: TaskParts) -> PressingForce:
    """How hard the tool presses along the path."""
    knots, values = task.force.knots()
    return PressingForce(knots, values, task.force.unit)


def _check_length(path: PathConfig) -> None:
    """Raises ConfigError for a pattern without length, or one that nobody waits for."""
    wide, high = path.size
    if path.pattern == "line" and wide == high == 0.0:
        raise ConfigError(
            "path.size = [0, 0] is no line: give it a length, or say path.pattern = 'hold' for a tool that stays"
        )
    filled = abs(wide * high) / path.spacing if path.pattern in ("raster", "spiral") else 0.0
    length = filled + 4.0 * (abs(wide) + abs(high)) * path.turns
    if not length <= _LONGEST:
        raise ConfigError(
            f"path: a {path.pattern} of {wide:g} by {high:g} m is about {length:.3g} m long, more than {_LONGEST:g} m:"
            " make path.size or path.turns smaller, or path.spacing larger"
        )


def _axes(task: TaskParts, surface: SurfaceGeometry, place: Array, normal: Array) -> tuple[Array, Array]:
    """u and v (3,) at a place: along a cylinder's axis or a plane's x axis, turned by `path.direction`."""
    along = exp3(math.radians(task.path.direction) * normal) @ surface.tangent(place, surface.first_axis(normal))
    return along, np.cross(normal, along)


def _heading(robot: Robot, frame: str, normal: Array) -> Array:
    """(3,) where the tool's x axis goes: as at home, after its z axis was turned the shortest way into the surface."""
    R = robot.placement(robot.home, frame)[1]
    axis = np.cross(R[:, 2], -normal)
    sine, cosine = float(np.linalg.norm(axis)), float(R[:, 2] @ -normal)
    if sine < 1e-6:
        return R[:, 0]
    return exp3(math.atan2(sine, cosine) / sine * axis) @ R[:, 0]


def _three(values: Array) -> tuple[float, float, float]:
    return float(values[0]), float(values[1]), float(values[2])
