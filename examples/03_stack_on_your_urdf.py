"""A stack of fractal impedances on any robot file: give it a URDF or MJCF, a tool frame and an elbow frame.

The torque is the sum of J_iᵀ h_i over the tasks, clamped to the robot's limits: no inverse, no projection, no inertia.
The first task holds position and orientation of the tool (6 axes), the second the position of the elbow (3 axes).

Run it:  python examples/03_stack_on_your_urdf.py                               (the LWR of the catalogue)
         python examples/03_stack_on_your_urdf.py my_arm.urdf tool0 forearm     (yours)

The robot is simulated in MuJoCo with joint damping and gravity compensation; its targets make a small circle. It first
prints what is unsafe about the parameters on this robot, then error, peak torque and where the energy went.
"""

from __future__ import annotations

import sys

import numpy as np

from pliant.controllers.config import FrameTaskConfig, RotationConfig, StackConfig, TranslationConfig
from pliant.controllers.registry import advise_stack, build_stack
from pliant.robot import Robot
from pliant.signals import Estimate, Measurement, Reference, TaskReference
from pliant.simulation import JointEffects, MujocoPlant

PERIOD = 1e-3  # s


def seen(measurement: Measurement) -> Estimate:
    """Sensors are perfect here; on a robot an estimator stands in this place."""
    return Estimate(measurement.time, measurement.q, measurement.v, measurement.torque, measurement.torque_sent)


def main(source: str = "lwr4", tool: str = "flange", elbow: str = "elbow") -> None:
    robot = Robot.load(source)
    config = StackConfig(
        tasks={
            "tool": FrameTaskConfig(
                frame=tool,
                translation=TranslationConfig(
                    stiffness=3000.0, force_max=60.0, range=0.05, linear_range=0.015
                ),  # N/m, N, m
                rotation=RotationConfig(
                    stiffness=30.0, force_max=8.0, range=0.5, linear_range=0.2
                ),  # N·m/rad, N·m, rad
            ),
            "elbow": FrameTaskConfig(
                frame=elbow,
                translation=TranslationConfig(stiffness=500.0, force_max=10.0, range=0.05, linear_range=0.01),
            ),
        }
    )
    for sentence in advise_stack(robot, config, PERIOD):
        print("warning:", sentence)
    controller = build_stack(robot, config, PERIOD)
    plant = MujocoPlant(robot, period=PERIOD, joints=JointEffects(damping=0.5, compensation="gravity"))

    centre, rotation = robot.placement(robot.home, tool)
    elbow_position, _ = robot.placement(robot.home, elbow)
    measurement, world = plant.init()
    state, errors, commands = controller.init(seen(measurement)), [], []
    for _ in range(5000):
        t = measurement.time
        circle = 0.03 * np.array([np.cos(2.0 * t) - 1.0, np.sin(2.0 * t), 0.0])  # m
        targets = (TaskReference(tool, centre + circle, rotation), TaskReference(elbow, elbow_position))
        command, state = controller.step(seen(measurement), Reference(t, targets), state)
        measurement, world = plant.step(command, world)
        errors.append(np.asarray(command.diagnostics["tool/error"])[:3])
        commands.append(command)

    peak = max(float(np.abs(command.torque).max()) for command in commands)
    rmse = 1e3 * np.sqrt(np.mean(np.square(errors), axis=0))
    print(f"{robot.name}: tool RMSE x, y, z = {np.round(rmse, 2).tolist()} mm, peak torque {peak:.1f} N·m")
    for name in ("supplied", "delivered", "stored", "dissipated", "clamped"):
        print(f"  energy {name:>10}: {float(commands[-1].diagnostics[f'energy/{name}']):8.4f} J")


if __name__ == "__main__":
    main(*sys.argv[1:4])
