"""The largest delay that stays stable and bounded, per environment and per place where it arises."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from pliant.experiments.case import Case, Row
from pliant.experiments.result import Result
from pliant.studies.haptic.scene_config import Material
from pliant.telemetry.plots import style

if TYPE_CHECKING:
    from matplotlib.figure import Figure

DELAYS = (1, 2, 3, 5, 8, 12, 20, 30, 50)
"""ms"""
SURFACES: Mapping[str, Material] = {
    "rigid, 1e6 N/m": Material(),
    "firm, 1e4 N/m": Material(stiffness=1e4, damping=4.6e2),
    "soft, 1e3 N/m": Material(stiffness=1e3, damping=1e2),
}
_SOFT_IMPEDANCE = {"stiffness": (375.0, 375.0, 750.0), "force_max": (10.0, 10.0, 20.0)}  # N/m, N
PLACES: Mapping[str, tuple[tuple[str, ...], dict[str, Any]]] = {
    "force signal": (("force_delay",), {}),
    "command": (("command_delay",), {}),
    "both": (("force_delay", "command_delay"), {}),
    "both, K_0 / 16": (("force_delay", "command_delay"), {"impedance": _SOFT_IMPEDANCE}),
    "both, damped joints": (("force_delay", "command_delay"), {"hardware": {"joint_damping": 11.46}}),
}
"""where the delay is → what is late, and what else changes: 16 times less stiffness, or experiment 4's damping"""
_STEADY_FORCE = 1.0  # N rms over the last half second: a tenth of the force that is asked for
_STEADY_SPEED = 0.05  # m/s
_BOUNDED_FORCE = 300.0  # N, F_max along z: what hits harder was not kept in bounds


def delay_rows() -> list[Row]:
    """Every surface, place and delay."""
    rows: list[Row] = []
    for surface, material in SURFACES.items():
        for place, (fields, more) in PLACES.items():
            for delay in DELAYS:
                changes = {
                    **more,
                    "environment": {"floor": {"material": material.model_dump()}},
                    "hardware": {**more.get("hardware", {}), **dict.fromkeys(fields, 1e-3 * delay)},
                }
                label = f"{surface} · {place} · {delay} ms"
                rows.append(Row(label, changes=changes, group=(surface, place), value=float(delay)))
    return rows


def stable(result: Result) -> bool:
    """Whether a run came to rest at its force and never hit harder than F_max."""
    values = {metric.name: metric.value for metric in result.metrics}
    if result.failure is not None or not values:
        return False
    calm = values["force, rms"] <= _STEADY_FORCE and values["speed at the end"] <= _STEADY_SPEED
    return calm and values["peak force"] <= _BOUNDED_FORCE and values["|W| over F_max"] <= 1.0


def largest_stable(case: Case[Any], results: Sequence[Result]) -> dict[tuple[str, ...], float]:
    """(surface, place) → the largest delay, ms, up to which every tried one was stable; 0: none."""
    verdicts = {(row.group, row.value): stable(run) for run in results if (row := case.row_of(run.config)) is not None}
    found: dict[tuple[str, ...], float] = {}
    for row in case.rows:
        if row.value is not None and verdicts.get((row.group, row.value), False):
            if found.get(row.group, 0.0) == _before(row.value):
                found[row.group] = row.value
        elif row.group:
            found.setdefault(row.group, 0.0)
    return found


def _before(delay: float) -> float:
    """The next smaller delay that is tried; 0 before the first."""
    place = DELAYS.index(int(delay))
    return float(DELAYS[place - 1]) if place else 0.0


def delay_figure(case: Case[Any], results: Sequence[Result]) -> Mapping[str, Figure]:
    """The largest stable delay as bars, a group per surface; none without a delayed run."""
    if all(row is None or row.value is None for row in map(case.row_of, (result.config for result in results))):
        return {}
    largest = largest_stable(case, results)
    made = style.figure(8.0, 3.8, "Largest delay that stays stable and bounded (tried: 1 to 50 ms)")
    ax = made.add_subplot()
    style.dress(ax, "", "delay, ms")
    width = 0.8 / len(PLACES)
    for index, place in enumerate(PLACES):
        x = np.arange(len(SURFACES)) + (index - 0.5 * (len(PLACES) - 1)) * width
        values = [largest[surface, place] for surface in SURFACES]
        bars = ax.bar(x, values, 0.9 * width, color=style.colour(index), label=place)
        labels = ["none" if value == 0.0 else f"{value:g}" for value in values]
        ax.bar_label(bars, labels, fontsize=style.SMALL, color=style.INK)
    ax.set_xticks(np.arange(len(SURFACES)), list(SURFACES))
    style.legend(ax, outside=True)
    return {"delay": made}
