"""Haptic exploration exactly as printed: [HapFIC] Tiseo et al. 2021, Algorithm 1. For comparison.

Its faults: the step δ = σ F_d/K_0 carries the sign of F_d, so that a negative F_d runs the wrong way; σ is a
share of a step and a threshold in newtons at once, and the band of 0.01 N lies below the force of one step, so that
it limit-cycles; the reset fires when the force is reached; a step per tick makes the speed depend on the control rate.
"""

from __future__ import annotations


def printed_step(
    desired: float, force: float, offset: float, stiffness: float, bound: float, resolution: float, reset: bool
) -> float:
    """One tick of Algorithm 1.

    Args:
        desired: F_d, N.
        force: F(t−1), N.
        offset: Δx(t−1), m.
        stiffness: K_0, N/m.
        bound: x_b, m.
        resolution: σ.
        reset: the printed Reset.

    Returns:
        Δx(t), m.
    """
    step = resolution * desired / stiffness if stiffness > 0.0 else 0.0
    missing = desired - force
    if abs(missing) >= resolution and desired != 0.0:
        if abs(force) <= resolution:
            return 0.0
        moved = offset - (step if missing > 0.0 else -step if missing < 0.0 else 0.0)
        return min(max(moved, -bound), bound)
    return 0.0 if reset else offset  # printed without a clamp: if the bound shrinks, it is exceeded
