"""Random tunings, and a mass on an axis: shared by the laws of the impedance."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from hypothesis import strategies as st

from pliant.controllers.attractor import Attractor, Law, PhaseSettings
from pliant.controllers.profiles import ForceProfile, Shape
from pliant.signals import ImpedanceTuning
from pliant.spatial import Array

SHAPES = st.sampled_from(list(Shape))


@st.composite
def profiles(draw: st.DrawFn, axes: int = 1) -> ForceProfile:
    """Any valid profile: x_0 given or derived, F_max from hardly above the knee to a hundred times."""
    stiffness = np.array([draw(st.floats(1.0, 2e4)) for _ in range(axes)])
    reach = np.array([draw(st.floats(1e-3, 0.6)) for _ in range(axes)])
    if draw(st.booleans()):
        bend = reach * np.array([draw(st.floats(0.0, 0.98)) for _ in range(axes)])
        force_max = np.maximum(stiffness * bend, 0.1) * np.array([draw(st.floats(1.0, 100.0)) for _ in range(axes)])
        tuning = ImpedanceTuning(stiffness, force_max, reach, bend)
    else:
        force_max = stiffness * reach * np.array([draw(st.floats(0.01, 20.0)) for _ in range(axes)])
        tuning = ImpedanceTuning(stiffness, force_max, reach)
    return ForceProfile.of(tuning, draw(SHAPES))


def profile_of(
    K_0: float, F_max: float, x_b: float, x_0: float | None = None, shape: Shape = Shape.EXPONENTIAL
) -> ForceProfile:
    """A profile of one axis."""
    bend = None if x_0 is None else np.array([x_0])
    return ForceProfile.of(ImpedanceTuning(np.array([K_0]), np.array([F_max]), np.array([x_b]), bend), shape)


@dataclass(frozen=True)
class MassRun:
    """Log of a mass on one axis, one row per tick."""

    error: Array
    force: Array
    velocity: Array
    converging: Array
    threshold: Array
    rate: Array


def run_mass(
    profile: ForceProfile,
    *,
    law: Law = Law.CAPPED,
    seconds: float = 2.0,
    period: float = 1e-3,
    mass: float = 1.5,
    damping: float = 0.0,
    start: float = 0.01,
    load: float = 0.0,
    target: Any = lambda t: 0.0,
    noise: float = 0.0,
    settings: PhaseSettings | None = None,
) -> MassRun:
    """A mass pulled by one impedance axis: the force is held over each period, the motion runs in ten steps."""
    attractor = Attractor(period, np.array([5e-4]), law, settings or PhaseSettings())
    rng = np.random.default_rng(3)
    x, v, state = -start, 0.0, None
    rows: list[tuple[float, ...]] = []
    for k in range(round(seconds / period)):
        error = np.array([target(k * period) - x])
        seen = error + noise * rng.standard_normal(1)
        state = attractor.init(seen) if state is None else state
        h, state = attractor.step(profile, seen, state)
        threshold = float(attractor.threshold(state)[0])
        rows.append((error[0], h[0], v, float(state.converging[0]), threshold, float(state.rate[0])))
        for _ in range(10):
            dt = period / 10
            a = (h[0] + load) / mass
            decay = np.exp(-damping / mass * dt)
            x += v * dt + 0.5 * a * dt * dt if damping == 0.0 else v * dt
            v = v * decay + a * dt * (1.0 if damping == 0.0 else (1.0 - decay) * mass / (damping * dt))
    return MassRun(*np.array(rows).T)
