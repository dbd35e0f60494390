"""Load a robot, look at it, and ask pinocchio and MuJoCo the same question.

A robot is a catalogue name (`pliant list robots`) or the path of a URDF or MJCF file. Everything that computes makes
its own data from `robot.model`, so one robot can serve many threads.
"""

import mujoco
import numpy as np
import pinocchio as pin

from pliant.mujoco_model import spec_from_robot
from pliant.robot import Robot, Tool

robot = Robot.load("iiwa14", locked={"A7": 0.0}, tool=Tool(length=0.20, mass=0.4))  # m, kg
print(f"{robot.name}: {robot.n} joints {robot.joint_names}")
print(f"torque limits {robot.torque_limit} N·m")

position, R_world_tool = robot.placement(robot.home, "tool")
print(f"at home the tool is at {np.round(position, 3)} m and points along {np.round(R_world_tool[:, 2], 3)}")

# The torque that holds the arm still at home, from pinocchio ...
gravity = pin.computeGeneralizedGravity(robot.model, robot.model.createData(), robot.home)

# ... and from MuJoCo, for which the same robot becomes a specification that scenes can be added to.
model = spec_from_robot(robot).compile()
data = mujoco.MjData(model)
data.qpos[:] = robot.home
mujoco.mj_forward(model, data)
print(f"holding torque {np.round(gravity, 2)} N·m; the two differ by {np.abs(gravity - data.qfrc_bias).max():.1e} N·m")
