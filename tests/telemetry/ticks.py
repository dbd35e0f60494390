"""Synthetic ticks with every kind of channel."""

from __future__ import annotations

import numpy as np

from pliant.signals import Command, Estimate, ImpedanceTuning, Measurement, Reference, TaskReference, Tick, Truth
from pliant.spatial import exp3

JOINTS = tuple(f"lwr_{i}" for i in range(7))


def make_tick(k: int, seed: int = 0, period: float = 1e-3) -> Tick:
    """Tick number k: random numbers that depend on the seed and on k alone."""
    rng = np.random.default_rng([seed, abs(k)])
    time = k * period

    def vector(size: int) -> np.ndarray:
        return rng.standard_normal(size)

    rotation = exp3(vector(3))
    tuning = ImpedanceTuning(np.full(6, 2500.0), np.full(6, 100.0), np.full(6, 0.06), np.full(6, 0.03))
    return Tick(
        measurement=Measurement(time, vector(7), vector(7), vector(7), vector(7), {"tool": vector(6)}),
        estimate=Estimate(
            time, vector(7), vector(7), vector(7), vector(7), {"tool": vector(6)}, {"tool": k % 2 == 0}, vector(7)
        ),
        reference=Reference(
            time,
            (
                TaskReference("tool", vector(3), rotation, vector(6), vector(6), vector(6), tuning),
                TaskReference("elbow", vector(3)),
            ),
            posture=vector(7),
            phase="reach" if k < 30 else "contact",
            diagnostics={"planner/progress": float(k)},
        ),
        command=Command(
            time,
            vector(7),
            vector(7),
            {
                "ee/energy_stored": float(rng.standard_normal()),
                "ee/force": vector(6),
                "gain/matrix": vector(6).reshape(2, 3),
            },
        ),
        truth=Truth(
            time,
            vector(7),
            vector(7),
            vector(7),
            {"tool": vector(3)},
            {"tool": exp3(vector(3))},
            {"tool": vector(6)},
            {"box": vector(7)},
        ),
        wall={"plan": 1e-5, "control": 2e-5 + 1e-9 * k},
    )
