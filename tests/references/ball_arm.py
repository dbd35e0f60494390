"""An arm with a ball for a tool, and the force with which it presses."""

from __future__ import annotations

import numpy as np

from pliant.references.toolpaths.pressing import PressingForce
from pliant.robot import Robot, Tool

RADIUS = 0.015  # m
ROBOT = Robot.load("iiwa14").with_tool(Tool(mass=0.3, length=0.15, radius=RADIUS, frame="tool"))
X = np.array([1.0, 0.0, 0.0])
PROFILE = PressingForce((0.0, 0.1, 1.0), (5.0, 25.0, 25.0))
