"""Adds estimated stiffness and damping of the environment to another estimator."""

from __future__ import annotations

import math
from typing import Any

import numpy.typing as npt

from pliant._estimation import EnvironmentStage
from pliant.estimation.chain import ChainedEstimator
from pliant.estimation.compiled_surface import compiled_surface, surface_facing
from pliant.estimation.environment_fit import EnvironmentFit, FitConfig
from pliant.interfaces import Estimator
from pliant.rigid_body import tree_of
from pliant.robot import Robot
from pliant.surfaces import SurfaceGeometry


class EnvironmentEstimator(ChainedEstimator):
    """Fills `Estimate.environments` for one contact frame, from its normal force and its motion.

    Source of the idea: [FFMPC] Kleff et al. 2024, sec. VIII-B, suggests the online estimation of K and B of its eq. 16;
        the method here is recursive least squares, see `EnvironmentFit`.

    Args:
        inner: reports the contact wrench of the frame.
        robot: kinematics.
        frame: that touches.
        period: s between two measurements.
        normal: (3,) outward normal of the surface in the world, or the believed surface itself where its normal turns.
            It must be the surface's normal: along another direction, sliding on the surface is a motion without force.
        config: parameters of the fit.
        sliding: m/s of tangential speed above which samples are ignored, for a normal that is not known exactly; None:
            no limit.
        reach: m from where the estimate was found beyond which it is dropped, for a stiffness that changes on the way;
            None: it is kept.
        kept: N/m; an estimate at least as stiff is not dropped, for what relies on it is safe with a stiffer one.

    Raises:
        RobotError: a frame that the robot does not have.
        ConfigError: a normal without length, or a cutoff above half the sampling rate.
    """

    def __init__(
        self,
        inner: Estimator[Any],
        robot: Robot,
        frame: str,
        period: float,
        *,
        normal: npt.ArrayLike | SurfaceGeometry = (0.0, 0.0, 1.0),
        config: FitConfig | None = None,
        sliding: float | None = None,
        reach: float | None = None,
        kept: float = math.inf,
    ) -> None:
        self.robot, self.frame, self.sliding, self.reach, self.kept = robot, frame, sliding, reach, kept
        self.surface = surface_facing(normal)
        self.fit = EnvironmentFit(config or FitConfig(), period)
        robot.frame_id(frame)
        slow, near = (math.inf if limit is None else limit for limit in (sliding, reach))
        surface = compiled_surface(self.surface)
        stage = EnvironmentStage(tree_of(robot.model), frame, surface, self.fit.core, slow, near, kept)
        super().__init__(stage, inner, frozenset(), environment=frame)
