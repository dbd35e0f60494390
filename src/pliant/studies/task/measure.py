"""Metrics of a task, on the true signals, along the true normal."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from pliant.errors import ConfigError, options
from pliant.spatial import Array
from pliant.surfaces import SurfaceGeometry
from pliant.telemetry import metrics as of
from pliant.telemetry.contact_metrics import break_share
from pliant.telemetry.log import Log
from pliant.telemetry.steadiness import largest_line, swing
from pliant.telemetry.summary import Metric

_LANDING = 0.2  # s after the first contact that still count as landing


@dataclass(frozen=True)
class TaskSignals:
    """What the metrics are made of."""

    time: Array
    """(k,) s"""
    force: Array
    """(k,) N along the true normal"""
    wanted: Array
    """(k,) N along the believed normal"""
    beside: Array
    """(k,) m, of the tool from its reference, in the true tangent plane"""
    following: npt.NDArray[np.bool_]
    """(k,) the path is run"""
    limit: Array
    """(k, n) share of each joint's torque limit that was sent"""
    place: Array = field(default_factory=lambda: np.zeros((0, 3)))
    """(k, 3) m, of the true surface nearest to the tool"""
    normal: Array = field(default_factory=lambda: np.zeros((0, 3)))
    """(k, 3) of the surface there"""


@dataclass(frozen=True)
class Measure:
    """A metric."""

    unit: str
    text: str
    of: Callable[[TaskSignals], float]
    worst: bool = False
    """whether the worst run decides, else the mean"""


def _landing_peak(s: TaskSignals) -> float:
    touching = np.flatnonzero(s.force > 0.0)
    if not touching.size:
        return 0.0
    first = float(s.time[touching[0]])
    return of.peak(s.force[of.between(s.time, first, first + _LANDING)])


def _steady(s: TaskSignals, share: Callable[[Array, Array, float], float]) -> float:
    """% of the wanted force; NaN where it does not stand still for long enough."""
    force, wanted = s.force[s.following], s.wanted[s.following]
    return 100.0 * share(force, wanted, float(np.median(np.diff(s.time))))


MEASURES: Mapping[str, Measure] = {
    "force_error": Measure(
        "N", "mean |force − wanted| along the true normal, on the path",
        lambda s: of.mae(s.force[s.following], s.wanted[s.following]),
    ),
    "force_error_max": Measure(
        "N", "largest |force − wanted| on the path",
        lambda s: of.max_error(s.force[s.following], s.wanted[s.following]), True,
    ),
    "force_peak": Measure("N", "largest normal force of the run", lambda s: of.peak(s.force), True),
    "landing_peak": Measure("N", "largest normal force shortly after the first contact", _landing_peak, True),
    "contact_lost": Measure(
        "%", "share of the path without contact", lambda s: 100.0 * break_share(s.force[s.following]), True
    ),
    "force_swing": Measure(
        "%", "largest standard deviation of the force, of the wanted one, in whole seconds in which that stands still",
        lambda s: _steady(s, swing), True,
    ),
    "force_line": Measure(
        "%", "largest line of the force's spectrum, 2 to 100 Hz, of the wanted force, in the same seconds",
        lambda s: _steady(s, largest_line), True,
    ),
    "path_error": Measure(
        "mm", "mean distance from the path, in the true tangent plane",
        lambda s: 1e3 * float(np.mean(s.beside[s.following])),
    ),
    "path_error_max": Measure(
        "mm", "largest distance from the path", lambda s: 1e3 * float(np.max(s.beside[s.following])), True
    ),
    "torque_share": Measure(
        "%", "largest torque as a share of its joint's limit", lambda s: 100.0 * of.peak(s.limit), True
    ),
}  # fmt: skip
"""name → metric; names that `accept` can bound"""
_STEADY = ("force_swing", "force_line")
WORST = tuple(name for name, measure in MEASURES.items() if measure.worst)


def check_accept(accept: Mapping[str, float]) -> None:
    """Raises ConfigError for a metric that there is not."""
    for name in accept:
        if name not in MEASURES:
            raise ConfigError(f"accept: there is no metric {name!r}; {options(MEASURES, name)}")


def measured(signals: TaskSignals, accept: Mapping[str, float]) -> tuple[Metric, ...]:
    """All metrics, with the bound that the task puts on them; none if the run ended before the path began.

    Those of steadiness are left out where the wanted force does not stand still for long enough and nobody asks.
    """
    if not np.any(signals.following):
        return ()
    found = {name: about.of(signals) for name, about in MEASURES.items()}
    told = [name for name, value in found.items() if name in accept or name not in _STEADY or not math.isnan(value)]
    return tuple(Metric(name, found[name], MEASURES[name].unit, target=accept.get(name)) for name in told)


def signals_of(log: Log, frame: str, surface: SurfaceGeometry, torque_limits: Array) -> TaskSignals:
    """The signals of a run. Args: surface: the true one."""
    time = log.time(f"truth/{frame}/wrench")
    place = log[f"truth/{frame}/position"]
    below = [surface.near(point) for point in place]
    normals = np.array([near.normal for near in below])
    asked = log[f"reference/{frame}/wrench"][:, :3]
    off = place - log[f"reference/{frame}/position"]
    off = off - normals * np.sum(off * normals, axis=1, keepdims=True)
    return TaskSignals(
        time,
        np.sum(log[f"truth/{frame}/wrench"][:, :3] * normals, axis=1),
        np.linalg.norm(asked, axis=1),
        np.linalg.norm(off, axis=1),
        _in_phase(log, time, "follow"),
        np.abs(log["command/torque"]) / torque_limits,
        np.array([near.point for near in below]),
        normals,
    )


def _in_phase(log: Log, time: Array, name: str) -> npt.NDArray[np.bool_]:
    """(k,): the reference is in that phase."""
    found = np.zeros(len(time), dtype=np.bool_)
    phases = log.phases()
    ends = [begin for begin, _ in phases[1:]] + [np.inf]
    for (begin, phase), end in zip(phases, ends, strict=True):
        if phase == name:
            found |= (time >= begin) & (time < end)
    return found
