"""Force ripple in Python: the twin of cpp/plant/imperfect_robot.cpp."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from pliant.simulation.imperfections.ripple import RippleConfig
from pliant.spatial import Array

_TURN = 2.0 * math.pi


@dataclass(frozen=True, slots=True)
class Ripple:
    """Adds the ripple to force/torque readings.

    The published hardware shows 30–40 Hz during polishing, a frequency proportional to speed and an amplitude that
    grows with force and speed; this is the simplest law that does so: every component of a wrench is scaled by `1 +
    a·sin φ`, with `a = amplitude/force · |v|/speed` and `φ̇ = 2π frequency · |v|/speed`.
    """

    config: RippleConfig
    period: float
    """s between two readings"""

    def init(self) -> float:
        """The phase at the start, rad."""
        return 0.0

    def step(self, wrenches: Mapping[str, Array], v: Array, phase: float) -> tuple[dict[str, Array], float]:
        """The readings, and the next phase.

        Args:
            wrenches: frame → (6,) true wrench.
            v: (n,) joint velocities, rad/s.
            phase: rad.
        """
        relative_speed = math.sqrt(float(v @ v)) / self.config.speed
        phase = (phase + _TURN * self.config.frequency * relative_speed * self.period) % _TURN
        share = self.config.amplitude / self.config.force * relative_speed * math.sin(phase)
        return {frame: wrench * (1.0 + share) for frame, wrench in wrenches.items()}, phase
