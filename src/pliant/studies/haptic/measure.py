"""Metrics of a haptic run: each check of its configuration becomes one metric, on true signals."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from pliant.errors import ConfigError
from pliant.spatial import Array
from pliant.studies.haptic.config import JUDGED, TASK, Check, HapticCaseConfig
from pliant.studies.haptic.scene import BOX
from pliant.telemetry import contact_metrics, metrics
from pliant.telemetry.log import Log
from pliant.telemetry.summary import Metric

LOWER_BOUNDS = ("unreachable",)
"""kinds whose target is a lower bound"""


@dataclass(frozen=True)
class HapticSignals:
    """The signals that checks look at, sampled at one set of times."""

    config: HapticCaseConfig
    log: Log
    time: Array
    """(n,) s"""
    force: Array
    """(n, 3) true force on the foot, N"""
    position: Array
    """(n, 3) true position, m"""
    reference: Array
    """(n, 3) of the impedance, exploration included, m"""

    @staticmethod
    def of(config: HapticCaseConfig, log: Log) -> HapticSignals:
        frame = config.frame
        return HapticSignals(
            config,
            log,
            log.time("measurement/q"),
            log[f"truth/{frame}/wrench"][:, :3],
            log[f"truth/{frame}/position"],
            log[f"reference/{frame}/position"],
        )

    def explored(self, name: str) -> Array:
        """(n, 3) a channel of the exploration; zero before there is one, and without exploration."""
        return self.channel(f"exploration/{self.config.frame}/{name}", (3,))

    def channel(self, name: str, shape: tuple[int, ...]) -> Array:
        """(n, *shape) any channel; zero where it has no sample."""
        found = np.zeros((len(self.time), *shape))
        if name in self.log:
            found[np.searchsorted(self.time, self.log.time(name) - 1e-9)] = self.log[name]
        return found

    @property
    def wanted(self) -> Array:
        """(n, 3) desired force, N, after the exploration's clamp."""
        return self.log[f"reference/{self.config.frame}/wrench"][:, :3]

    def speed(self) -> Array:
        """(n,) of the foot, m/s."""
        steps = np.diff(self.position, axis=0, prepend=self.position[:1])
        return np.linalg.norm(steps, axis=1) / self.config.period


Window = npt.NDArray[np.bool_]


def measure(config: HapticCaseConfig, log: Log) -> tuple[Metric, ...]:
    """One metric per check. Targets are pliant's: baselines have none."""
    signals = HapticSignals.of(config, log)
    return tuple(_metric(check, signals, config.controller == JUDGED) for check in config.checks)


def _metric(check: Check, signals: HapticSignals, judged: bool) -> Metric:
    window = metrics.between(signals.time, check.begin, np.inf if check.end is None else check.end)
    unit, function = _KINDS[check.kind]
    value = function(check, signals, window) if window.any() else math.nan  # the run ended before
    target = check.target if judged else None
    unit = "1" if check.relative else unit
    return Metric(check.name, float(value), unit, target=target, at_least=check.kind in LOWER_BOUNDS)


def _error(check: Check, signals: HapticSignals, window: Window) -> Array:
    """(n,) force error along the check's axis, N."""
    wanted = signals.wanted[window, check.axis] if check.wanted is None else check.wanted
    error = signals.force[window, check.axis] - wanted
    return error / np.abs(wanted) if check.relative else error


def _rms(check: Check, signals: HapticSignals, window: Window) -> float:
    return float(np.sqrt(np.mean(_error(check, signals, window) ** 2)))


def _max(check: Check, signals: HapticSignals, window: Window) -> float:
    return float(np.max(np.abs(_error(check, signals, window))))


def _settle(check: Check, signals: HapticSignals, window: Window) -> float:
    time, force = signals.time[window], signals.force[window, check.axis]
    before = float(force[0]) if check.before is None else check.before
    return contact_metrics.settling_time(time, force, _wanted(check), before, check.begin)


def _breaks(check: Check, signals: HapticSignals, window: Window) -> float:
    return contact_metrics.contact_breaks(np.copysign(1.0, _wanted(check)) * signals.force[window, check.axis])


def _peak(check: Check, signals: HapticSignals, window: Window) -> float:
    return metrics.peak(np.linalg.norm(signals.force[window], axis=1))


def _lateral(check: Check, signals: HapticSignals, window: Window) -> float:
    across = [axis for axis in range(3) if axis != check.axis]
    return 1e3 * metrics.max_error(signals.position[window][:, across], signals.reference[window][:, across])


def _return(check: Check, signals: HapticSignals, window: Window) -> float:
    return 1e3 * metrics.max_error(signals.position[window], signals.reference[window])


def _offset(check: Check, signals: HapticSignals, window: Window) -> float:
    return 1e3 * metrics.peak(signals.explored("offset")[window])


def _off_bound(check: Check, signals: HapticSignals, window: Window) -> float:
    offset = np.abs(signals.explored("offset")[window, check.axis])
    return 1e3 * float(np.max(np.abs(offset - signals.config.impedance.range[check.axis])))


def _beyond_bound(check: Check, signals: HapticSignals, window: Window) -> float:
    bound = signals.channel(f"reference/{signals.config.frame}/range", (3,))
    return 1e3 * float(np.max(np.abs(signals.explored("offset")) - bound))


def _unreachable(check: Check, signals: HapticSignals, window: Window) -> float:
    return float(np.mean(signals.explored("unreachable")[window, check.axis]))


def _tilt(check: Check, signals: HapticSignals, window: Window) -> float:
    """Degrees between what the box has turned by about the horizontal, at the end, and 90°."""
    _, _, _, w, x, y, z = signals.log[f"truth/objects/{BOX}/pose"][-1]
    up = 1.0 - 2.0 * (x * x + y * y)  # world z of the box's z axis, of a unit quaternion
    assert abs(w * w + x * x + y * y + z * z - 1.0) < 1e-6
    return abs(float(np.degrees(np.arccos(np.clip(up, -1.0, 1.0)))) - 90.0)


def _speed(check: Check, signals: HapticSignals, window: Window) -> float:
    return metrics.peak(signals.speed()[window])


def _over(check: Check, signals: HapticSignals, window: Window) -> float:
    """How far the force exceeds the desired one along the check's axis, N."""
    wanted = signals.wanted[window, check.axis]
    side = np.where(wanted < 0.0, -1.0, 1.0)
    return float(np.max(side * (signals.force[window, check.axis] - wanted)))


def _link(check: Check, signals: HapticSignals, window: Window) -> float:
    return metrics.peak(np.linalg.norm(signals.log["truth/shank/wrench"][window, :3], axis=1))


def _knee(check: Check, signals: HapticSignals, window: Window) -> float:
    """Smallest angle of the last joint: 0 is the straight leg, where the Jacobian loses a rank."""
    return float(np.degrees(np.min(np.abs(signals.log["truth/q"][window, -1]))))


def _reachable(check: Check, signals: HapticSignals, window: Window) -> float:
    return metrics.peak(signals.explored("reachable")[window, check.axis] - _wanted(check))


def _wanted(check: Check) -> float:
    if check.wanted is None:
        raise ConfigError(f"check {check.name!r} of kind {check.kind!r} needs `wanted`, the force that was asked for")
    return check.wanted


def _share(check: Check, signals: HapticSignals, window: Window) -> float:
    if f"{TASK}/force" not in signals.log:
        return math.nan  # a controller without an impedance at the foot
    force = np.abs(signals.channel(f"{TASK}/force", (3,)))
    bound = signals.channel(f"reference/{signals.config.frame}/force_max", (3,))
    return float(np.max((force / bound)[window]))


_KINDS: Mapping[str, tuple[str, Callable[[Check, HapticSignals, Window], float]]] = {
    "rms": ("N", _rms),
    "max": ("N", _max),
    "settle": ("s", _settle),
    "breaks": ("", _breaks),
    "peak": ("N", _peak),
    "lateral": ("mm", _lateral),
    "return": ("mm", _return),
    "offset": ("mm", _offset),
    "off-bound": ("mm", _off_bound),
    "beyond-bound": ("mm", _beyond_bound),
    "unreachable": ("1", _unreachable),
    "tilt": ("deg", _tilt),
    "speed": ("m/s", _speed),
    "over": ("N", _over),
    "link": ("N", _link),
    "knee": ("deg", _knee),
    "reachable": ("N", _reachable),
    "share": ("1", _share),
}
"""kind of check → unit, and how it is measured"""
