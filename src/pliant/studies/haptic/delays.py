"""The largest delay that stays stable and bounded, per environment and per place where it arises."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.figure import Figure

from pliant.spatial import Array
from pliant.studies.base import Result
from pliant.studies.config import merged
from pliant.studies.haptic.config import HapticConfig, Material
from pliant.telemetry.plots import sweep

DELAYS = (1, 2, 3, 5, 8, 12, 20, 30, 50)
"""ms"""
SURFACES: Mapping[str, Material] = {
    "rigid, 1e6 N/m": Material(),
    "firm, 1e4 N/m": Material(stiffness=1e4, damping=4.6e2),
    "soft, 1e3 N/m": Material(stiffness=1e3, damping=1e2),
}
PLACES: Mapping[str, tuple[str, ...]] = {
    "force": ("force_delay",),
    "command": ("command_delay",),
    "both": ("force_delay", "command_delay"),
}
_STEADY_FORCE = 1.0  # N rms over the last half second: a tenth of the force that is asked for
_STEADY_SPEED = 0.05  # m/s


def delay_runs(config: HapticConfig) -> list[HapticConfig]:
    """Every surface, place and delay."""
    runs: list[HapticConfig] = []
    for surface, material in SURFACES.items():
        for place, fields in PLACES.items():
            for delay in DELAYS:
                hardware = dict.fromkeys(fields, 1e-3 * delay)
                changes = {
                    "environment": {"floor": {"material": material.model_dump()}},
                    "hardware": hardware,
                    "variant": f"{surface} · {place} · {delay} ms",
                }
                runs.append(merged(config, changes))
    return runs


def stable(result: Result) -> bool:
    """Whether a run kept its force, its contact and its rest."""
    values = {metric.name: metric.value for metric in result.metrics}
    if result.failure is not None or not values:
        return False
    calm = values["force, rms"] <= _STEADY_FORCE and values["speed at the end"] <= _STEADY_SPEED
    return calm and values["|W| over F_max"] <= 1.0


def largest_stable(results: Sequence[Result]) -> dict[tuple[str, str], float]:
    """(surface, place) → the largest delay, ms, up to which every tried one was stable; 0: none."""
    found: dict[tuple[str, str], float] = {}
    verdicts = {r.config.variant: stable(r) for r in results if r.config.case == "delay" and r.config.variant}
    for surface in SURFACES:
        for place in PLACES:
            largest = 0
            for delay in DELAYS:
                if not verdicts.get(f"{surface} · {place} · {delay} ms", False):
                    break
                largest = delay
            found[surface, place] = float(largest)
    return found


def delay_figure(results: Sequence[Result]) -> Figure:
    """Force error against the delay; runs that are not stable are crosses at the upper edge."""
    by_variant = {r.config.variant: r for r in results if r.config.case == "delay" and r.config.variant}
    largest = largest_stable(results)
    curves: dict[str, Array] = {}
    for surface in SURFACES:
        for place in PLACES:
            label = f"{surface}; {place}: ≤ {largest[surface, place]:g} ms"
            curves[label] = np.array([_error(by_variant, f"{surface} · {place} · {delay} ms") for delay in DELAYS])
    title = "Largest delay that stays stable and bounded, per environment"
    return sweep(np.array(DELAYS, float), curves, "delay, ms", "force error, N rms", title, log_x=True)


def _error(results: Mapping[str, Result], variant: str) -> float:
    result = results.get(variant)
    if result is None or not stable(result):
        return np.nan
    return next(metric.value for metric in result.metrics if metric.name == "force, rms")
