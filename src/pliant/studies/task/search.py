"""How any controller is tuned on a task: parameters by their keys, other seeds than a table's, one objective."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from pliant.configuration import merged
from pliant.dotted import nested
from pliant.entries import Believed
from pliant.errors import ConfigError, options
from pliant.experiments.base import Result
from pliant.experiments.parameter_search import ParameterSearch, Range
from pliant.robot import Robot
from pliant.studies.task.config import TaskCase

FIRST_SEED = 1000
"""far from those of tables: what was tuned on is no test"""
_SEEDS = 2
_WIDTH = 10.0  # by which a gain may shrink or grow where the task names no range
_DECADE = 10.0  # a range as wide as that is searched by its order of magnitude
_GAINS = ("weight", "stiffness", "damping", "gain", "damping_ratio", "posture_stiffness", "force_integral")
"""last parts of the keys that are searched where the task has no `[tune]`"""


_WEIGHTS = {
    "force_error": 1.0, "path_error": 1.0, "force_error_max": 0.05, "contact_lost": 0.1,
    "force_rms": 1.0, "force_max": 0.05, "contact_breaks": 1.0,
    "position_max": 0.05, "rmse_x": 1.0, "rmse_y": 1.0, "rmse_z": 1.0,
}  # fmt: skip
"""metric → what one of its unit (N, mm, %, number) costs"""


@dataclass(frozen=True)
class Searched:
    """What is known of a task before it is tuned."""

    robot: Robot
    believed: Believed


def search_of(case: TaskCase, searched: Searched) -> ParameterSearch:
    """The search over the parameters of a task's controller: those of `[tune]`, or its gains. A row of numbers, such as
    one per axis, is searched by its largest entry; the others keep their ratio to it.

    Raises:
        ConfigError: a key of `[tune]` that is no number among the controller's parameters, or nothing to search.
    """
    controller, believed = case.controller, searched.believed
    values = dict(_values(case.controller_parameters(searched.robot, believed).model_dump()))
    numbers = {key: max(np.atleast_1d(value).tolist()) for key, value in values.items()}
    found = _asked(case.tune, numbers, controller) if case.tune else _gains(numbers, tuple(believed.phases))
    if not found:
        raise ConfigError(
            f"controller {controller!r} has no parameter whose key ends in {', '.join(_GAINS)}: say in the task which"
            f" ones are searched, for example [tune] {next(iter(numbers), 'gain')} = [1.0, 10.0]"
        )
    runs = [merged(case, {"seed": FIRST_SEED + index}) for index in range(_SEEDS)]
    start = {key: min(max(numbers[key], about.low), about.high) for key, about in found.items()}

    def applied(sampled: Mapping[str, float]) -> Mapping[str, Any]:
        return {"control": {controller: nested({key: _as_large(values[key], x) for key, x in sampled.items()})}}

    return ParameterSearch(found, runs, objective, start, applied)


def objective(results: Sequence[Result]) -> float:
    """What the metrics cost, each the mean over the runs and the phases that have it: 1 per N of the mean (RMS) force
    error and per mm of the mean path error (RMSE per axis), a twentieth per N of the largest force error and
    per mm of the largest distance from the reference, a tenth per %
    of the time without contact, 1 for each loss of contact."""
    costs: dict[str, list[float]] = {}
    for result in results:
        for metric in result.metrics:
            name = metric.name.rpartition("/")[2]
            if name in _WEIGHTS:
                costs.setdefault(name, []).append(_WEIGHTS[name] * metric.value)
    return float(sum(np.mean(values) for values in costs.values())) if costs else math.nan


def _asked(tune: Mapping[str, tuple[float, float]], numbers: Mapping[str, float], controller: str) -> dict[str, Range]:
    found: dict[str, Range] = {}
    for key, (low, high) in tune.items():
        if key not in numbers:
            raise ConfigError(f"tune: controller {controller!r} has no number {key!r}; {options(numbers, key)}")
        found[key] = Range(low, high, log=low > 0.0 and high >= _DECADE * low)
    return found


def _gains(numbers: Mapping[str, float], phases: Sequence[str]) -> dict[str, Range]:
    """Every gain above zero, but those of phases that the task does not have."""
    return {
        key: Range(value / _WIDTH, value * _WIDTH, log=True)
        for key, value in numbers.items()
        if value > 0.0 and key.rpartition(".")[2] in _GAINS and _plays_a_part(key, phases)
    }


def _plays_a_part(key: str, phases: Sequence[str]) -> bool:
    parts = key.split(".")
    return "phases" not in parts or parts[parts.index("phases") + 1] in phases


def _values(tree: Mapping[str, Any], above: str = "") -> Iterator[tuple[str, float | tuple[float, ...]]]:
    """Dotted key and value of every finite real number, and of every row of numbers above zero."""
    for name, value in tree.items():
        if isinstance(value, Mapping):
            yield from _values(value, f"{above}{name}.")  # pyright: ignore[reportUnknownArgumentType]
        elif isinstance(value, float) and math.isfinite(value):
            yield above + name, value
        elif isinstance(value, tuple) and value and all(isinstance(x, float) and 0.0 < x < math.inf for x in value):  # pyright: ignore[reportUnknownVariableType]
            yield above + name, value  # pyright: ignore[reportUnknownArgumentType]


def _as_large(value: float | tuple[float, ...], largest: float) -> float | tuple[float, ...]:
    """A number, or a row whose largest entry it is and whose others keep their ratio to it."""
    return tuple(largest / max(value) * entry for entry in value) if isinstance(value, tuple) else largest
