"""Where the robot should be and how hard it should press: trajectories, planners, posture, haptic exploration.

Postures are in `pliant.references.posture_source`; they need MuJoCo and mink, which take a moment to import.
"""

from pliant.references.attractor_planner import AttractorPlanner
from pliant.references.exploration_config import ExplorationConfig
from pliant.references.haptic_exploration import HapticExploration
from pliant.references.harmonic_planner import HarmonicPlanner, PlannerLimits
from pliant.references.sampled import read_motion
from pliant.references.schedule import Mailbox, Schedule
from pliant.references.shapes import Harmonics, circle, lemniscate, sine_line
from pliant.references.source import FrameMotion, TrajectorySource
from pliant.references.steps import Waypoints, wrench_steps
from pliant.references.superposition import MotionLimits
from pliant.references.trajectory import Blend, Chain, Hold, Trajectory, Warped
from pliant.references.workspace import Workspace, workspace_of

__all__ = [
    "AttractorPlanner",
    "Blend",
    "Chain",
    "ExplorationConfig",
    "FrameMotion",
    "HapticExploration",
    "HarmonicPlanner",
    "Harmonics",
    "Hold",
    "Mailbox",
    "MotionLimits",
    "PlannerLimits",
    "Schedule",
    "Trajectory",
    "TrajectorySource",
    "Warped",
    "Waypoints",
    "Workspace",
    "circle",
    "lemniscate",
    "read_motion",
    "sine_line",
    "workspace_of",
    "wrench_steps",
]
