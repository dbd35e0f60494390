"""The bound on torque steps in NumPy: what `cpp/guard/step_limit.hpp` computes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pliant.spatial import Array


@dataclass(frozen=True)
class BoundTorques:
    """After a tick: joint positions, rad; torques that were sent and held back, N·m; energy withheld, J."""

    q: Array
    sent: Array
    held_back: Array
    energy: float
    exceeded: float | None = None


def bound_step(last: BoundTorques, wanted: Array, q: Array, step_max: Array, spendable: float) -> BoundTorques:
    """One tick. Args: wanted, (n,) N·m; step_max, (n,) N·m; spendable, J, infinite where nobody says it."""
    way = q - last.q
    energy = last.energy + float(last.held_back @ way)
    torque = np.minimum(np.maximum(wanted, last.sent - step_max), last.sent + step_max)
    held_back = wanted - torque
    if not held_back.any():
        return BoundTorques(q, torque, held_back, energy)
    exceeded, cost = 0.0, -float(held_back @ way)
    if cost > spendable:
        held_back = spendable / cost * held_back
        torque = wanted - held_back
        exceeded = max(float((np.abs(torque - last.sent) / step_max).max()) - 1.0, 0.0)
    return BoundTorques(q, torque, held_back, energy, exceeded)
