"""How far each joint of the catalogue goes beyond its limit under 100 % of its torque, at rest on the stop and thrown.

    python benchmarks/joint_stops.py                 every robot of the catalogue that is installed
    python benchmarks/joint_stops.py iiwa14 lwr4     these

At rest: the joint starts on its limit and is pushed for 0.5 s; the largest excess of the last 0.1 s. At speed: it
starts on its limit with its speed limit (2 rad/s where the file gives none) and the same push; the largest excess.
Thrown: it starts at the robot's home and is pushed for 1.5 s, the other joints hanging loose, and reaches the stop at
speeds that no drive has; the largest excess of all, or what ended it.
"""

from __future__ import annotations

import sys
from dataclasses import replace

import mujoco
import numpy as np

from pliant.errors import RunFailedError
from pliant.robot import Robot
from pliant.robots import CATALOGUE, is_available
from pliant.signals import Command
from pliant.simulation import JointEffects, MujocoPlant


def excess(
    plant: MujocoPlant, joint: int, torque: float, seconds: float, at: float | None = None, speed: float = 0.0
) -> np.ndarray:
    """(k,) excess of a joint over its limit, rad (m where it slides), while it is pushed.

    Args: torque: N·m; at, speed: where and how fast it starts, rad and rad/s; None: at home and at rest.
    """
    _, world = plant.init()
    if at is not None:
        world.data.qpos[joint], world.data.qvel[joint] = at, speed
        mujoco.mj_step1(plant.model, world.data)
    torques = np.zeros(plant.robot.n)
    torques[joint] = torque
    found = []
    for _ in range(round(seconds / plant.period)):
        _, world = plant.step(Command(0.0, torques, np.zeros_like(torques)), world)
        beyond = plant.truth(world).limit_excess
        assert beyond is not None
        found.append(beyond[joint])
    return np.array(found)


def degrees(excess: np.ndarray) -> float:
    """The largest, in degrees."""
    return float(np.degrees(excess).max())


def main(robots: list[str]) -> None:
    print(f"{'robot':<10} {'worst at rest':>32} {'worst at speed':>32} {'worst thrown':>32}   [degrees]")
    for name in robots or [name for name, entry in CATALOGUE.items() if is_available(entry)]:
        robot = replace(Robot.load(name), visual=None)
        plant = MujocoPlant(robot, joints=JointEffects(compensation="gravity"))
        rest: dict[str, float] = {}
        fast: dict[str, float] = {}
        thrown: dict[str, float] = {}
        for joint, label in enumerate(robot.joint_names):
            lower, upper = float(robot.position_lower[joint]), float(robot.position_upper[joint])
            if not (np.isfinite(upper - lower) and 0.0 < upper - lower < 1e3):
                continue
            limit = float(robot.torque_limit[joint])
            limit = limit if np.isfinite(limit) else 100.0  # N·m, where the file gives none
            speed = float(robot.velocity_limit[joint])
            speed = speed if np.isfinite(speed) else 2.0  # rad/s
            for side, at in ((-1, lower), (1, upper)):
                key = f"{label} {'+' if side > 0 else '-'}"
                rest[key] = degrees(excess(plant, joint, side * limit, 0.5, at)[-100:])
                fast[key] = degrees(excess(plant, joint, side * limit, 0.2, at, side * speed))
                try:
                    thrown[key] = degrees(excess(plant, joint, side * limit, 1.5))
                except RunFailedError:
                    thrown[f"{key}, diverged"] = np.inf
        cells = [max(table.items(), key=lambda item: item[1]) for table in (rest, fast, thrown) if table]
        print(f"{name:<10} " + " ".join(f"{value:>8.2f} ({key:>21})" for key, value in cells), flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
