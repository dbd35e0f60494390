"""Press 20 N with a robot whose commands are 5 ms late, whose drives are wrong by up to 20 %, and whose joints rub.

Force feedback alone cannot do it. `OffsetFreeMpc` rolls the measured state through the torques that are under way,
takes the disturbance that a momentum observer finds out of what it sends, and integrates the force error.

Run it:  python examples/06_offset_free_mpc.py            (with the compensations)
         python examples/06_offset_free_mpc.py stock      (without them: it does not even come down to the table)
"""

from __future__ import annotations

import sys

import numpy as np
import pinocchio as pin

from pliant.errors import RunFailedError
from pliant.estimation import EnvironmentEstimator, JointStateFilter, MomentumObserver, WrenchEstimator
from pliant.mpc import ForceFeedbackMpc, MpcController, OffsetFreeMpc
from pliant.robot import Robot, Tool
from pliant.signals import Reference, TaskReference
from pliant.simulation import ForceSensor, Imperfections, ImperfectPlant, MujocoPlant, Scene, Surface, table

FORCE, BALL, PERIOD = 20.0, 0.015, 1e-3  # N, m, s


def main(which: str = "offset-free") -> None:
    robot = Robot.load("iiwa14", locked={"A7": 0.0}, tool=Tool(frame="tool")).with_contact("tool", BALL)
    start, R = robot.placement(robot.home, "tool")
    surface = (start[0], start[1], start[2] - BALL - 0.010)
    physics = MujocoPlant(
        robot,
        Scene((table(surface, tilt=0.05, surface=Surface(1e4, 1e2, 0.25)),)),  # N/m, N·s/m, 1
        period=5e-4,
        sensors=[ForceSensor("tool")],
        speed_stop=2.0,
    )
    held = pin.computeGeneralizedGravity(robot.model, robot.model.createData(), robot.home)
    plant = ImperfectPlant(physics, Imperfections.p3(pid=False, computation_delay=5e-3), seed=1, holding_torque=held)

    felt = JointStateFilter(WrenchEstimator(robot))  # joint positions without their noise
    surroundings = EnvironmentEstimator(felt, robot, "tool", PERIOD, sliding=0.02)  # stiffness of what is touched
    estimator = MomentumObserver(surroundings, robot, late_readings=1)  # torque that the model does not explain
    config = ForceFeedbackMpc() if which == "stock" else OffsetFreeMpc()
    controller = MpcController(robot, config, PERIOD)

    measurement, world = plant.init()
    est = estimator.init(measurement)
    ctl, forces, stopped = None, [], ""
    try:
        for _ in range(4000):
            estimate, est = estimator.step(measurement, est)
            ctl = ctl or controller.init(estimate)
            down = np.array([0.0, 0.0, -0.02 * min(estimate.time, 1.0)])  # 20 mm/s
            wrench = np.array([0.0, 0.0, FORCE, 0.0, 0.0, 0.0])
            phase = "contact" if estimate.contacts["tool"] else "track"
            task = TaskReference("tool", start + down, R, wrench=wrench)
            command, ctl = controller.step(estimate, Reference(estimate.time, (task,), phase=phase), ctl)
            measurement, world = plant.step(command, world)
            forces.append(plant.truth(world).wrenches["tool"][2])
    except RunFailedError as error:
        stopped = f", then {error}"
    settled = np.array(forces[2000:] or forces)
    print(f"{which}: asked {FORCE:g} N, got {settled.mean():.2f} ± {settled.std():.2f} N{stopped}")


if __name__ == "__main__":
    main(*sys.argv[1:2])
