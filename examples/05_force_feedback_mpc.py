"""Force-feedback MPC on any serial arm: come down until something is felt, press with 20 N, draw a small circle.

The measured contact force is part of the state that is predicted (Kleff et al. 2024, section V), so that the torque
answers to it five nodes ahead. The reference has no phases: the controller takes the weights of free motion or of
contact as the estimate says whether the tool touches.

Run it:  python examples/05_force_feedback_mpc.py                         (the iiwa 14 of the catalogue)
         python examples/05_force_feedback_mpc.py my_arm.urdf tool0       (yours: a serial chain of up to 8 joints)

A simulated table stands 10 mm under the tool at the robot's home configuration. Its stiffness and friction are unknown
to the controller, which believes in K = 3 kN/m without friction.
"""

from __future__ import annotations

import sys

import numpy as np

from pliant.estimation import WrenchEstimator
from pliant.mpc import Contact, ForceFeedbackMpc, MpcController
from pliant.robot import Robot
from pliant.signals import Reference, TaskReference
from pliant.simulation import ForceSensor, MujocoPlant, Scene, Surface, table

FORCE, RADIUS, SPEED, BALL = 20.0, 0.03, 2.0, 0.015  # N, m, rad/s, m


def main(source: str = "iiwa14", tool: str = "flange") -> None:
    robot = Robot.load(source).with_contact(tool, BALL)
    start, R = robot.placement(robot.home, tool)
    surface = (start[0], start[1], start[2] - BALL - 0.010)
    plant = MujocoPlant(robot, Scene((table(surface, surface=Surface(friction=0.2)),)), sensors=[ForceSensor(tool)])
    estimator = WrenchEstimator(robot)
    config = ForceFeedbackMpc(frame=tool, contact=Contact(stiffness=(3e3,), damping=(100.0,)))  # N/m, N·s/m
    controller = MpcController(robot, config)

    measurement, world = plant.init()
    est = estimator.init(measurement)
    ctl, touched, forces = None, None, []
    for _ in range(6000):
        estimate, est = estimator.step(measurement, est)
        ctl = ctl or controller.init(estimate)
        touched = estimate.time if touched is None and estimate.contacts[tool] else touched
        down = np.array([0.0, 0.0, -0.02 * min(estimate.time, 2.0)])  # 20 mm/s
        angle = 0.0 if touched is None else SPEED * max(estimate.time - touched - 1.0, 0.0)
        turn = RADIUS * np.array([1.0 - np.cos(angle), np.sin(angle), 0.0])
        wrench = np.array([0.0, 0.0, FORCE, 0.0, 0.0, 0.0])
        task = TaskReference(tool, start + down + turn, R, wrench=wrench)
        command, ctl = controller.step(estimate, Reference(estimate.time, (task,)), ctl)
        measurement, world = plant.step(command, world)
        forces.append(plant.truth(world).wrenches[tool][2])

    settled = np.array(forces[3000:])
    felt = "never" if touched is None else f"at {touched:.2f} s"
    print(f"{robot.name}: contact felt {felt}, asked {FORCE:g} N, got {settled.mean():.2f} ± {settled.std():.2f} N")


if __name__ == "__main__":
    main(*sys.argv[1:3])
