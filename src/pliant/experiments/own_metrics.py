"""A user's metrics: functions of a run's log and configuration, by name.

Another package offers its own through the entry-point group `pliant.metrics` (name = "module:metric"). Without being
installed, one is chosen as `my_module:metric` or `my_file.py:metric`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from importlib.metadata import entry_points
from typing import Any

import numpy as np

from pliant.errors import ConfigError, options, told
from pliant.telemetry.log import Log
from pliant.telemetry.summary import Metric
from pliant.wiring.plugins import imported

GROUP = "pliant.metrics"

OwnMetric = Callable[[Log, Any], "Metric | Iterable[Metric]"]
"""log, the run's configuration → one metric or several"""


def find_metric(name: str) -> OwnMetric:
    """The function that a name stands for.

    Raises:
        ConfigError: there is none, with the names there are; or what is found is not a function.
    """
    found: Any
    if ":" in name:
        found = imported(name)
    else:
        offered = {point.name: point.value for point in entry_points(group=GROUP)}
        if name not in offered:
            raise ConfigError(
                f"there is no metric {name!r}; {options(offered, name)}; or write my_module:metric or my_file.py:metric"
            )
        found = imported(offered[name])
    function: OwnMetric = found
    if not callable(found):
        raise ConfigError(f"metric {name!r} must be a function (log, config) -> Metric, got {found!r}")
    return function


def own_metrics(names: Sequence[str], config: Any, log: Log) -> tuple[Metric, ...]:
    """The values of a user's metrics for a run.

    Raises:
        ConfigError: one fails, or returns something else than metrics.
    """
    return tuple(metric for name in names for metric in _measured(name, config, log))


def _measured(name: str, config: Any, log: Log) -> list[Metric]:
    try:
        found = find_metric(name)(log, config)
        metrics = [found] if isinstance(found, Metric) else list(found)
    except ConfigError:
        raise
    except (Exception, SystemExit) as error:  # any error of the user's code
        raise ConfigError(f"metric {name!r} fails on {log.source}: {told(error)}") from error
    if any(not isinstance(metric, Metric) for metric in metrics):  # pyright: ignore[reportUnnecessaryIsInstance]
        raise ConfigError(f"metric {name!r} must return a pliant.Metric or several, got {found!r}")
    for metric in metrics:
        value: Any = metric.value
        if isinstance(value, bool) or not isinstance(value, int | float | np.floating | np.integer):
            raise ConfigError(f"metric {name!r}: the value of {metric.name!r} must be a number, got {metric.value!r}")
    return metrics
