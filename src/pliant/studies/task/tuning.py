"""How any controller is tuned on a task: parameters by their keys, other seeds than a table's, one objective."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from pliant.configuration import merged
from pliant.errors import ConfigError, options
from pliant.experiments.base import Result
from pliant.experiments.tuning import Range, Tuning, nested
from pliant.studies.task.build import planned
from pliant.studies.task.config import TaskCase

FIRST_SEED = 1000
"""far from those of tables: what was tuned on is no test"""
_SEEDS = 2
_WIDTH = 10.0  # by which a gain may shrink or grow where the task names no range
_DECADE = 10.0  # a range as wide as that is searched by its order of magnitude
_GAINS = ("weight", "stiffness", "damping", "gain", "damping_ratio", "posture_stiffness", "force_integral")
"""last parts of the keys that are searched where the task has no `[tune]`"""


def tuning_of(case: TaskCase, controller: str) -> Tuning:
    """The search over a controller's parameters on a task: those of `[tune]`, or its gains.

    Raises:
        ConfigError: a key of `[tune]` that is no number among the controller's parameters, or nothing to search.
        PliantError: a task that cannot be built.
    """
    config = merged(case, {"controller": controller})
    made = planned(config)
    believed = config.believed(made.surface)
    numbers = dict(_numbers(config.controller_parameters(made.robot, believed).model_dump()))
    found = _asked(config.tune, numbers, controller) if config.tune else _gains(numbers, tuple(believed.phases))
    if not found:
        raise ConfigError(
            f"controller {controller!r} has no parameter whose key ends in {', '.join(_GAINS)}: say in the task which"
            f" ones are searched, for example [tune] {next(iter(numbers), 'gain')} = [1.0, 10.0]"
        )
    runs = [merged(config, {"seed": FIRST_SEED + index}) for index in range(_SEEDS)]
    start = {key: min(max(numbers[key], about.low), about.high) for key, about in found.items()}
    return Tuning(found, runs, objective, start, lambda values: {"control": {controller: nested(values)}})


def objective(results: Sequence[Result]) -> float:
    """Mean force error in N, plus path error in mm, a twentieth of the largest force error in N and a tenth of the
    share without contact in %; mean over the runs."""
    found = [{metric.name: metric.value for metric in result.metrics} for result in results]
    costs = [
        run["force_error"] + run["path_error"] + 0.05 * run["force_error_max"] + 0.1 * run["contact_lost"]
        for run in found
    ]
    return float(np.mean(costs))


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


def _numbers(tree: Mapping[str, Any], above: str = "") -> Iterator[tuple[str, float]]:
    """Dotted key and value of every finite real number."""
    for name, value in tree.items():
        if isinstance(value, Mapping):
            yield from _numbers(value, f"{above}{name}.")  # pyright: ignore[reportUnknownArgumentType]
        elif isinstance(value, float) and math.isfinite(value):
            yield above + name, value
