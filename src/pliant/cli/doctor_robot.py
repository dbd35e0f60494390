"""`pliant doctor ROBOT`: what was read from a robot file, what is missing, and what was assumed."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from rich.console import Console
from rich.table import Table

from pliant.errors import ConfigError
from pliant.robot import Robot


def print_robot(console: Console, source: str, locked: Sequence[str] = ()) -> None:
    """Prints joints, limits, home, masses, gravity, frames and notes of a robot.

    Args:
        console: where it prints.
        source: name or file.
        locked: `joint=angle` (rad or m) of joints that are fixed; none: those that the catalogue locks.

    Raises:
        RobotError: it cannot be loaded.
        ConfigError: `locked` names no joint of it, or no angle.
    """
    robot = Robot.load(source, locked=dict(map(_lock, locked)) or None)
    console.print(_joints(robot))
    gravity = np.round(np.array(robot.model.gravity.linear), 4).tolist()
    mass = sum(float(inertia.mass) for inertia in list(robot.model.inertias)[1:])
    lines = [
        f"read from  {robot.source or robot.name}",
        f"home       {robot.home_from}",
        f"rotors     {robot.rotors_from or 'none: nobody says their inertia'}",
        f"gravity    {gravity} m/s², in the robot's base",
        f"mass       {mass:.3f} kg that move",
        f"frames     {', '.join(robot.frame_names)}",
    ]
    for line in lines:
        console.print(line, markup=False, highlight=False, soft_wrap=True)
    for note in robot.notes:
        console.print(f"note: {note}", style="yellow", markup=False, highlight=False, soft_wrap=True)
    for fault in robot.faults:
        console.print(f"cannot be simulated: {fault}", style="red", markup=False, highlight=False, soft_wrap=True)


def _lock(text: str) -> tuple[str, float]:
    joint, _, angle = text.rpartition("=")
    try:
        return joint, float(angle)
    except ValueError:
        raise ConfigError(f"--locked takes JOINT=ANGLE in rad or m, e.g. finger=0, got {text!r}") from None


def _joints(robot: Robot) -> Table:
    table = Table(title=f"{robot.name}, {robot.n} joints", title_justify="left", header_style="bold")
    table.add_column("joint", no_wrap=True)
    for heading in ("home", "from", "to", "torque, N·m", "speed, rad/s or m/s", "rotor, kg m²", "link, kg"):
        table.add_column(heading, justify="right")
    for index, name in enumerate(robot.joint_names):
        row = [
            robot.home[index],
            robot.position_lower[index],
            robot.position_upper[index],
            robot.torque_limit[index],
            robot.velocity_limit[index],
            robot.armature[index],
            float(robot.model.inertias[index + 1].mass),
        ]
        table.add_row(name, *(f"{value:.4g}" if np.isfinite(value) else "none" for value in row))
    return table
