"""Delays that a controller assumes."""

from __future__ import annotations

from pliant.configuration import Config
from pliant.quantity import quantity


class TimingConfig(Config):
    """Delays of readings and commands that the controller assumes; `truth.imperfections` has the true ones."""

    sensing_delay: float = quantity(
        1e-3, "s", "delay of a reading", assumed="sensors of [FFMPC] sec. VI-B; measure yours", ge=0.0, le=0.1
    )
    computation_delay: float = quantity(
        5e-3,
        "s",
        "from a reading to the effect of its command",
        assumed="that of [FFMPC] sec. VI-B; measure yours",
        ge=0.0,
        le=0.1,
    )

    @property
    def delay(self) -> float:
        """s, from what is measured to the effect of its command."""
        return self.sensing_delay + self.computation_delay
