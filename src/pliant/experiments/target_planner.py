"""How targets that jump become motion: the planner that a study or a task, and the controller, ask for."""

from __future__ import annotations

from typing import Any

from pliant.entries import ControllerEntry
from pliant.errors import ConfigError
from pliant.interfaces import Lookahead, ReferenceSource
from pliant.references.planners.attractor_planner import AttractorPlanner
from pliant.references.planners.curves import Planner
from pliant.references.planners.harmonic_attractor import AttractorSettings
from pliant.references.planners.harmonic_planner import HarmonicPlanner, PlannerLimits
from pliant.references.planners.superposition import MotionLimits
from pliant.references.planners.workspace import workspace_of
from pliant.robot import Robot
from pliant.tasks.phase import PlannerConfig


def target_planner(
    config: PlannerConfig,
    entry: ControllerEntry[Any],
    wanted: ReferenceSource[Any],
    robot: Robot,
    frame: str,
    lookahead: Lookahead | None = None,
) -> Planner:
    """Motion through targets.

    Args:
        config: what is asked for.
        entry: of the controller, which may have a planner of its own.
        wanted: the targets.
        robot: whose frame moves.
        frame: that moves.
        lookahead: preview that is wanted.

    Raises:
        ConfigError: a preview is wanted of the attractor planner, whose way depends on where the robot is.
    """
    kind = config.kind if config.kind == "printed" else entry.planner or config.kind
    if kind != "superposition":
        if lookahead is not None:
            raise ConfigError(
                f"controller {entry.name!r} wants a preview, which planner.kind = {kind!r} cannot give;"
                " valid: 'superposition'"
            )
        # as printed, eq. 3 gets stuck or runs away and nothing else could be compared: the corrected reading
        settings = AttractorSettings(config.speed, config.acceleration, printed=kind == "printed")
        return AttractorPlanner(wanted, robot.placement, settings)
    limits = PlannerLimits(linear=MotionLimits(config.speed, config.acceleration))
    return HarmonicPlanner(wanted, robot.placement, limits, {frame: workspace_of(robot, frame)}, lookahead)
