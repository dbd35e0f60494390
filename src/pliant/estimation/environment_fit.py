"""Stiffness and damping of what a robot touches, from force and motion: recursive least squares with forgetting."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from pydantic import Field

from pliant._estimation import FIT_COVARIANCE, FIT_FOUND, FIT_SIZE
from pliant._estimation import EnvironmentFit as CompiledFit
from pliant.configuration import Config
from pliant.environment import Environment
from pliant.estimation.filters import Butterworth
from pliant.quantity import quantity
from pliant.spatial import Array


@dataclass(frozen=True, slots=True)
class FitState:
    """State of the fit."""

    memory: Array = field(default_factory=lambda: np.zeros(FIT_SIZE))
    """numbers of the compiled fit"""

    @property
    def covariance(self) -> Array:
        """(3, 3) of depth, its rate and force (m, m/s, N) since first contact, exponentially weighted."""
        return self.memory[FIT_COVARIANCE : FIT_COVARIANCE + 9].reshape(3, 3)

    @property
    def found(self) -> Environment | None:
        """The last estimate that was accurate enough; it is kept after the contact ends."""
        known, *belief = self.memory[FIT_FOUND : FIT_FOUND + 5].tolist()
        return Environment(*belief) if known else None


class FitConfig(Config):
    """Forgetting factor, filter and thresholds of the fit."""

    memory: float = quantity(
        300.0,
        "1",
        "number of used samples after which the weight of a sample has fallen to 1/e; unused samples"
        " (standstill) do not count",
        gt=0.0,
        le=1e9,
    )
    cutoff: float = quantity(
        50.0,
        "Hz",
        "of the Butterworth filter of all three signals; the same filter for each keeps their relation",
        gt=0.0,
        le=1e6,
    )
    touch: float = quantity(2.0, "N", "above which there is contact", ge=0.0, le=1e6)
    least_force: float = quantity(
        0.1,
        "N",
        "least change of the force since the last used sample; a few times its noise after the filter",
        ge=0.0,
        le=1e6,
    )
    least_motion: float = quantity(
        1e-7,
        "m",
        "least change of the depth since then; above the position noise after the filter",
        ge=0.0,
        le=1.0,
    )
    noise_depth: float = quantity(
        0.0, "m", "standard deviation of the depth before the filter; see `EnvironmentFit`", ge=0.0, le=1.0
    )
    noise_rate: float = quantity(0.0, "m/s", "the same of its rate", ge=0.0, le=1e3)
    least_samples: int = Field(default=40, ge=1, le=10**9, description="samples before the first estimate")
    accuracy: float = quantity(
        0.2, "1", "largest relative standard uncertainty of K in an estimate that is returned", gt=0.0, le=1e12
    )
    drift: float = quantity(
        0.0,
        "Hz",
        "below which changes of force and depth are ignored: while the tool slides, a tilt or another stiffness"
        " changes the depth without a force; 0: none",
        ge=0.0,
        le=1e6,
    )


class EnvironmentFit:
    """F = K p + B ṗ + c along the normal, with depth p from an unknown zero.

    Least squares over (p, ṗ, 1) with exponential forgetting, in the form of weighted means and covariances, which
    eliminates c, does not wind up, and stays accurate between 3e2 and 1e6 N/m. Samples count only when force and motion
    have changed: without this condition, noise would replace the data while the robot rests.

    Motion noise pulls K towards zero by the factor 1/(1 + σ_p²/var p), σ_p after the filter (errors in variables). If
    its standard deviation is given, its variance is subtracted from var p, which removes this bias, and a contact whose
    motion does not exceed the noise (var p < 3 σ_p²) is not identified at all. A force that is δ s older than the
    motion shifts B by −K δ.

    With `drift`, the slow mean of all three (first order, the same for each) is taken off after the filter, so that
    the rest of F = K p + B ṗ + c holds although c changes slowly: the surface is tilted otherwise than believed, or its
    stiffness changes along the way. Rest and smooth sliding then tell nothing, and the last estimate stays.

    Args:
        config: see there.
        period: s between two samples.
    """

    def __init__(self, config: FitConfig, period: float) -> None:
        self.config = config
        filter_ = Butterworth(config.cutoff, period)
        passed = min(1.0, 2.22 * config.cutoff * period)  # share of white noise's variance: noise bandwidth 1.11 f_c
        self.core = CompiledFit(
            filter=filter_.coefficients,
            touch=config.touch,
            least_force=config.least_force,
            least_motion=config.least_motion,
            noise=(passed * config.noise_depth**2, passed * config.noise_rate**2),
            correlated=1.0 / passed,
            samples=config.memory,
            least_samples=config.least_samples,
            accuracy=config.accuracy,
            drift=1.0 - math.exp(-2.0 * math.pi * config.drift * period),
        )

    def step(self, force: float, depth: float, rate: float, state: FitState) -> FitState:
        """One sample.

        Args:
            force: N, normal, positive where the environment pushes.
            depth: m along the inward normal, from any fixed zero.
            rate: m/s of the depth.
            state: of the step before.
        """
        memory = state.memory.copy()
        self.core.step(force, depth, rate, memory)
        return FitState(memory)
