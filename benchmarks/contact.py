"""Speed of the explicit contact law against real time, as JSON. Run: python benchmarks/contact.py [seconds]"""

from __future__ import annotations

import json
import sys
import time

import numpy as np

from pliant.robot import Robot
from pliant.signals import Command
from pliant.simulation import Ball, Box, MujocoPlant, Scene, Surface, floor
from pliant.simulation.scene import Thing

RIGID = Surface(stiffness=1e6, damping=1e4, friction=0.5, friction_moving=0.3)
SOFT = Surface(stiffness=1e3, damping=1e2, friction=0.5, friction_moving=0.3)
PHYSICS_STEP = 2e-5  # s


def scenes(robot: Robot) -> dict[str, tuple[Thing, ...]]:
    """The foot stands on the floor in each; other things lie beside it."""
    x, _ = robot.placement(robot.home, "foot")
    ground = floor(x[2] - 0.02, RIGID)
    top = float(x[2]) - 0.02
    return {
        "floor": (ground,),
        "floor and box": (ground, Box("box", (0.12, 0.2, 0.2), (0.4, 0.0, top + 0.1), 2.0, surface=RIGID)),
        "floor and ball": (ground, Ball("ball", 0.1, (0.4, 0.0, top + 0.1), 0.5, SOFT)),
    }


def measure(robot: Robot, things: tuple[Thing, ...], seconds: float) -> dict[str, float]:
    """Simulates with a constant torque that presses the foot down; median over periods."""
    plant = MujocoPlant(robot, Scene(things, contact="explicit"), physics_step=PHYSICS_STEP)
    measurement, world = plant.init()
    walls = np.zeros(round(seconds / plant.period))
    for k in range(walls.size):
        torque = np.array([0.0, -2.0, 4.0]) - 2.0 * measurement.v
        start = time.perf_counter()
        measurement, world = plant.step(Command(measurement.time, torque, np.zeros(3)), world)
        walls[k] = time.perf_counter() - start
    return {
        "times faster than real time, median": round(plant.period / float(np.median(walls)), 2),
        "times faster than real time, 99th percentile": round(plant.period / float(np.percentile(walls, 99)), 2),
        "physics step [µs]": round(float(np.median(walls)) / plant.substeps * 1e6, 2),
    }


def main() -> None:
    seconds = float(sys.argv[1]) if len(sys.argv) > 1 else 2.0
    robot = Robot.load("leg3")
    print(
        json.dumps(
            {name: measure(robot, things, seconds) for name, things in scenes(robot).items()},
            indent=2,
            ensure_ascii=False,
        )
    )


if __name__ == "__main__":
    main()
