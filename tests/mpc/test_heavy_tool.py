"""Force feedback behind a wrist sensor that carries a heavy tool: the true contact force is the one that was asked."""

from __future__ import annotations

import numpy as np

from pliant.estimation import CarriedMass, WrenchEstimator
from pliant.mpc import Contact, ForceFeedbackMpc, MpcController
from pliant.robot import Robot, Tool
from pliant.signals import Reference, TaskReference
from pliant.simulation import ForceSensor, MujocoPlant, Scene, Surface, table

LENGTH, BALL, FORCE = 0.2, 0.015, 20.0  # m, m, N


def pressed(mass: float, carried: CarriedMass) -> np.ndarray:
    """True contact force along z in the second half of 3 s, N."""
    robot = Robot.load("iiwa14", tool=Tool(length=LENGTH, mass=mass)).with_contact("tool", BALL)
    start, R = robot.placement(robot.home, "tool")
    below = (start[0], start[1], start[2] - BALL - 0.010)
    sensor = ForceSensor("flange", mass, (0.0, 0.0, LENGTH / 2))
    plant = MujocoPlant(robot, Scene((table(below, surface=Surface(friction=0.2)),)), sensors=[sensor])
    estimator = WrenchEstimator(robot, {"flange": carried}, contact_frames={"flange": "tool"})
    controller = MpcController(robot, ForceFeedbackMpc(frame="tool", contact=Contact(stiffness=(3e3,))))
    measurement, world = plant.init()
    est, ctl, forces = estimator.init(measurement), None, []
    for _ in range(3000):
        estimate, est = estimator.step(measurement, est)
        ctl = ctl or controller.init(estimate)
        down = np.array([0.0, 0.0, -0.02 * min(estimate.time, 2.0)])
        task = TaskReference("tool", start + down, R, wrench=np.array([0.0, 0.0, FORCE, 0.0, 0.0, 0.0]))
        command, ctl = controller.step(estimate, Reference(estimate.time, (task,)), ctl)
        measurement, world = plant.step(command, world)
        forces.append(plant.truth(world).wrenches["tool"][2])
    return np.array(forces)[1500:]


def test_a_known_tool_of_2_kg_presses_as_asked() -> None:
    forces = pressed(2.0, CarriedMass(2.0, (0.0, 0.0, LENGTH / 2)))
    assert np.abs(forces - FORCE).max() < 1.0


def test_a_tool_that_nobody_named_presses_wrongly() -> None:
    """Baseline: its weight counts as contact force; the mean alone is off by twice the other test's bound."""
    forces = pressed(2.0, CarriedMass())
    assert abs(float(forces.mean()) - FORCE) > 2.0
