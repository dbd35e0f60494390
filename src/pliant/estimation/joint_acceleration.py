"""Joint accelerations from joint velocities."""

from __future__ import annotations

import math
from dataclasses import dataclass

from pliant.errors import ConfigError


@dataclass(frozen=True)
class JointAcceleration:
    """Differences of v after two equal first-order stages.

    Its error, for a sampling period T and α = 1 − e^{−2π f_c T}: it is delayed by 2 T (1 − α)/α + T/2, so the relative
    error of an oscillation of ω rad/s is ω times that, 0.8 % at 1 Hz with 200 Hz and 1 ms; white noise σ_v on v becomes
    σ_v √(2 α³/(2 − α)³) / T on the acceleration, 0.6 rad/s² for 1e-3 rad/s. If the inertial force of a heavy tool is
    compensated too late, a force controller oscillates: lower the cutoff only as far as the noise of v requires.

    Raises:
        ConfigError: on construction, when the cutoff is not above zero.
    """

    cutoff: float = 200.0
    """f_c of each stage, Hz"""

    def __post_init__(self) -> None:
        if not (math.isfinite(self.cutoff) and self.cutoff > 0.0):
            raise ConfigError(f"the cutoff of joint accelerations must be above 0 Hz, got {self.cutoff} Hz")
