"""Definition of a search over a controller's parameters: ranges, runs and objective."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from pliant.dotted import nested
from pliant.errors import ConfigError, options
from pliant.experiments.base_config import CaseConfig
from pliant.experiments.result import Result

PENALTY = 1e9
"""objective of a set of parameters if every run fails; if some runs fail, that share of it"""


@dataclass(frozen=True)
class Range:
    """Range in which a parameter is searched.

    Raises:
        ConfigError: on construction, if it is empty, or logarithmic and not above zero.
    """

    low: float
    high: float
    log: bool = False
    """whether the parameter is sampled on a logarithmic scale"""

    def __post_init__(self) -> None:
        if not (math.isfinite(self.low) and math.isfinite(self.high) and self.low < self.high):
            raise ConfigError(f"a range needs finite low < high, got {self.low:g} and {self.high:g}")
        if self.log and self.low <= 0.0:
            raise ConfigError(f"a logarithmic range needs low above 0, got {self.low:g}")


@dataclass(frozen=True)
class ParameterSearch:
    """A search. The runs should differ from those of the study's table, so that the table is an independent test.

    Raises:
        ConfigError: on construction, if there is nothing to search or the start does not fit the parameters.
    """

    parameters: Mapping[str, Range]
    """dotted key of the configuration → range"""
    runs: Sequence[CaseConfig]
    """runs on which every set of parameters is evaluated"""
    objective: Callable[[Sequence[Result]], float] = field(repr=False)
    """results of all the runs, none of which failed → a number, lower is better"""
    start: Mapping[str, float]
    """present values; they are tried first, so that the best is never worse"""
    apply: Callable[[Mapping[str, float]], Mapping[str, Any]] | None = field(default=None, repr=False)
    """sampled numbers → nested changes of the configuration; None: each number goes to its own key"""

    def __post_init__(self) -> None:
        if not self.parameters or not self.runs:
            raise ConfigError("a search needs at least one parameter and one run")
        if set(self.start) != set(self.parameters):
            raise ConfigError(f"the start of a search needs one value per parameter: {options(self.parameters)}")
        for name, range_ in self.parameters.items():
            if not range_.low <= self.start[name] <= range_.high:
                raise ConfigError(
                    f"the start of {name} must lie in {range_.low:g} … {range_.high:g}, got {self.start[name]:g}"
                )

    def changes(self, values: Mapping[str, float]) -> Mapping[str, Any]:
        """Nested changes of a run's configuration that stand for sampled values."""
        return nested(values) if self.apply is None else self.apply(values)

    def judge(self, results: Sequence[Result]) -> float:
        """The objective; large but finite where runs failed or it is not a number, larger the more runs failed."""
        failed = sum(result.failure is not None for result in results)
        if failed:
            return PENALTY * failed / len(results)
        value = float(self.objective(results))
        return value if math.isfinite(value) else PENALTY
