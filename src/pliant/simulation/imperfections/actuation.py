"""Motors and gears: from the torque command of the drives to the joint torque (cpp/plant/imperfect_robot.cpp).

    τ = a F(τ_m) + b − μ_s tanh(v/v_0) − μ_v v + ν        F the peak torque, then a first-order lag

All of it happens before the torque sensor, which therefore sees it. The printed equation has the joint position in the
friction terms where the velocity is meant, and one noise for both the torque and its reading: here the reading's noise
belongs to `SensingConfig`. Sources: [FFMPC] eq. 31; [HapFIC] sec. III, experiment 4.
"""

from __future__ import annotations

from pliant.configuration import Config
from pliant.quantity import Range, quantity
from pliant.simulation.imperfections.link_config import PerJoint


class ActuationConfig(Config):
    """From motor torque to torque at the link side of the joint."""

    gain: Range = quantity((1.0, 1.0), "1", "a is drawn uniformly from this range, per joint and run")
    bias: Range = quantity((0.0, 0.0), "N·m", "b is drawn uniformly from this range, per joint and run")
    dry_friction: PerJoint = quantity(0.0, "N·m", "μ_s of μ_s tanh(v/v_0)")
    friction_velocity: float = quantity(0.1, "rad/s", "v_0 of μ_s tanh(v/v_0)", gt=0.0, le=10.0)
    viscous_friction: PerJoint = quantity(0.0, "N·m s/rad", "μ_v")
    noise: PerJoint = quantity(0.0, "N·m", "standard deviation of the torque itself, drawn every period")
    bandwidth: float | None = quantity(
        None, "Hz", "corner of the first-order torque response; none: immediate", gt=0.0, le=1e5
    )
    peak_torque: float | None = quantity(
        None, "N·m", "largest motor torque of every joint; none: no limit", gt=0.0, le=1e5
    )
