"""Random tunings, and a mass on an axis: shared by the laws of the impedance."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from hypothesis import strategies as st

from pliant import _impedance
from pliant.controllers.attractor import Law
from pliant.controllers.energy_ledger import channel_table
from pliant.controllers.passivity_account import AccountSettings
from pliant.controllers.phase_settings import PhaseSettings
from pliant.controllers.profiles import ForceProfile, Shape
from pliant.signals import ImpedanceTuning
from pliant.spatial import Array

SHAPES = st.sampled_from([Shape.EXPONENTIAL, Shape.TANH])  # the printed ones jump


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
    load: Any = 0.0,
    target: Any = lambda t: 0.0,
    noise: float = 0.0,
    settings: PhaseSettings | None = None,
    account: bool = True,
) -> MassRun:
    """A mass pulled by one axis of the compiled core; the force is held over each period, the motion is exact."""
    settings = settings or PhaseSettings()
    core = _impedance.Stack(
        law=law.value,
        period=period,
        rate_gain=settings.rate_gain(period),
        noise_gain=settings.noise_gain(period),
        hold_limit=settings.hold_limit,
        blend_step=settings.blend_step(period),
        account=AccountSettings().numbers(period) if account and law is Law.CAPPED else None,
        torque_limit=np.array([np.inf]),
        tasks=[(3, profile.shape.value, settings.rate_floor, settings.rate_floor_angular, [True])],
    )
    numbers = (profile.stiffness, profile.force_max, profile.range, profile.linear_range)
    tuning = np.concatenate([[number[0], 0.0, 0.0] for number in numbers])
    table = channel_table(1, [("axis", 3)])
    columns = [table[f"axis/{name}"].start for name in ("force", "phase", "rate_threshold", "rate")]
    memory, out = np.zeros(core.state_size), np.zeros(core.output_size)
    J = np.zeros((6, 1), order="F")
    J[0, 0] = 1.0
    steps = round(seconds / period)
    seen_noise = noise * np.random.default_rng(3).standard_normal(steps)
    push = load if callable(load) else lambda t: load
    x, v, rows = -start, 0.0, []
    for k in range(steps):
        t = k * period
        error = target(t) - x
        q, aim = np.array([x - seen_noise[k]]), np.array([target(t), 0.0, 0.0])
        seen = np.array([q[0], 0.0, 0.0])
        core.step(memory, out, q, J, (seen, None), (aim, None), None, ((0, tuning),) if k == 0 else None)
        h, converging, threshold, rate = out[columns]
        rows.append((error, h, v, converging, threshold, rate))
        x, v = moved(x, v, h + push(t), mass, damping, period)
    return MassRun(*np.array(rows).T)


def moved(x: float, v: float, force: float, mass: float, damping: float, period: float) -> tuple[float, float]:
    """Position and velocity of a damped mass after a period under a constant force."""
    if damping == 0.0:
        return x + v * period + 0.5 * force / mass * period**2, v + force / mass * period
    final, decay = force / damping, np.exp(-damping / mass * period)
    return x + final * period + (v - final) * (1.0 - decay) * mass / damping, final + (v - final) * decay
