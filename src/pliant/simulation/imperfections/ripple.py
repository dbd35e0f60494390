"""Force ripple from the gearing: an oscillation whose pitch follows the joints' speed ([FFMPC] sec. VIII-C)."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from pliant.configuration import Config
from pliant.quantity import quantity
from pliant.spatial import Array

_TURN = 2.0 * math.pi


class RippleConfig(Config):
    """How strong the ripple is at a reference speed and force, and how fast it oscillates there."""

    amplitude: float = quantity(
        0.0, "N", "at the reference speed and force; 0 switches the ripple off", ge=0.0, le=100.0
    )
    frequency: float = quantity(35.0, "Hz", "at the reference speed", gt=0.0, le=500.0)
    speed: float = quantity(0.35, "rad/s", "reference: Euclidean norm of the joint velocities", gt=0.0, le=100.0)
    force: float = quantity(50.0, "N", "reference: magnitude of the contact force", gt=0.0, le=1e4)


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
