"""Where the robot should be and how hard it should press: trajectories, planners, posture, haptic exploration.

Postures are in `pliant.references.postures.posture_source`; they need MuJoCo and mink, which take a moment to import.
"""

from pliant.references.exploration.config import ExplorationConfig
from pliant.references.exploration.haptic_exploration import HapticExploration
from pliant.references.planners.attractor_planner import AttractorPlanner
from pliant.references.planners.harmonic_planner import HarmonicPlanner, PlannerLimits
from pliant.references.planners.superposition import MotionLimits
from pliant.references.planners.workspace import Workspace, workspace_of
from pliant.references.schedule import LatestReference, Schedule
from pliant.references.source import FrameMotion, TrajectorySource
from pliant.references.trajectories.sampled import read_motion
from pliant.references.trajectories.shapes import Harmonics, circle, lemniscate, sine_line
from pliant.references.trajectories.trajectory import Blend, Chain, Hold, Trajectory, Warped
from pliant.references.trajectories.waypoints import Waypoints, wrench_steps

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
    "LatestReference",
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
