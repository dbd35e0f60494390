"""When an axis of the fractal attractor is said to diverge or to converge: thresholds and times."""

from __future__ import annotations

import math

from pliant.configuration import Config
from pliant.quantity import quantity


class PhaseSettings(Config):
    """How an axis decides between divergence and convergence. The defaults serve noise-free and noisy robots alike."""

    rate_cutoff: float = quantity(80.0, "Hz", "low-pass on the rate of the error", gt=0.0)
    rate_floor: float = quantity(0.5e-3, "m/s", "rates below it do not determine a direction", gt=0.0)
    rate_floor_angular: float = quantity(0.5e-3, "rad/s", "rates below it do not determine a direction", gt=0.0)
    noise_time: float = quantity(
        0.2,
        "s",
        "time over which the noise of the error is learned; the threshold is at least 3σ of the filtered rate",
        gt=0.0,
    )
    hold_limit: float = quantity(
        0.030, "s", "how long a phase is held while the rate is below the threshold; then the axis diverges", ge=0.0
    )
    blend_time: float = quantity(
        0.008,
        "s",
        "time over which the force steps up where a convergence ends; 0: at once. If it is much"
        " shorter than an oscillation, it costs no damping and avoids a step of the joint torques",
        ge=0.0,
    )

    def rate_gain(self, period: float) -> float:
        """Share of a new difference in the filtered rate, for a period in s."""
        return -math.expm1(-2.0 * math.pi * self.rate_cutoff * period)

    def noise_gain(self, period: float) -> float:
        """Share of a new sample in the noise variance, for a period in s."""
        return -math.expm1(-period / self.noise_time)

    def blend_step(self, period: float) -> float:
        """Share of the force's step that one period in s takes away."""
        return min(1.0, period / self.blend_time) if self.blend_time > 0.0 else 1.0

    def noise_to_rate(self, period: float) -> float:
        """1/s: standard deviation of the filtered rate per standard deviation of a white error."""
        gain = self.rate_gain(period)
        return gain / period * math.sqrt(2.0 / (2.0 - gain))
