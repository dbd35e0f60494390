"""Metrics of several runs as a table of rows."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from typing import Any

from pliant.experiments import base
from pliant.telemetry.columns import data_frame


class MetricRows(ABC):
    """Results that can be had as a data frame."""

    @abstractmethod
    def columns(self) -> dict[str, list[Any]]:
        """Columns as lists."""

    def to_pandas(self) -> Any:
        """`columns` as a pandas DataFrame.

        Raises:
            MissingExtraError: pandas is not installed.
        """
        return data_frame("pandas", self.columns())

    def to_polars(self) -> Any:
        """The same as a polars DataFrame."""
        return data_frame("polars", self.columns())

    @staticmethod
    def rows(runs: Sequence[base.Result], more: Mapping[str, Sequence[Any]]) -> dict[str, list[Any]]:
        """One row per run and metric: controller, seed, metric, value, unit, failure; a run without metrics has one
        row. Args: runs; more: further columns, an entry per run, which go first."""
        found = [
            (*(values[place] for values in more.values()), run.config.controller, run.config.seed, *metric, run.failure)
            for place, run in enumerate(runs)
            for metric in ([(m.name, m.value, m.unit) for m in run.metrics] or [(None, None, None)])
        ]
        names = (*more, "controller", "seed", "metric", "value", "unit", "failure")
        return {name: [row[place] for row in found] for place, name in enumerate(names)}
