"""Force ripple from the gearing: an oscillation whose frequency follows the joints' speed ([FFMPC] sec. VIII-C;
cpp/plant/imperfect_robot.cpp).

The published hardware shows 30–40 Hz during polishing, a frequency proportional to speed and an amplitude that grows
with force and speed; this is the simplest law that does so: every component of a wrench is scaled by `1 + a·sin φ`,
with `a = amplitude/force · |v|/speed` and `φ̇ = 2π frequency · |v|/speed`.
"""

from __future__ import annotations

from pliant.configuration import Config
from pliant.quantity import quantity


class RippleConfig(Config):
    """Amplitude and frequency of the ripple at a reference speed and force."""

    amplitude: float = quantity(
        0.0, "N", "at the reference speed and force; 0 switches the ripple off", ge=0.0, le=100.0
    )
    frequency: float = quantity(35.0, "Hz", "at the reference speed", gt=0.0, le=500.0)
    speed: float = quantity(0.35, "rad/s", "reference: Euclidean norm of the joint velocities", gt=0.0, le=100.0)
    force: float = quantity(50.0, "N", "reference: magnitude of the contact force", gt=0.0, le=1e4)
