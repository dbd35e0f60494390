"""A case of a study as one value: its runs, rows and draws, and the paper's numbers and targets."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from pliant.configuration import merged
from pliant.experiments.base_config import CaseConfig
from pliant.experiments.result import Result
from pliant.telemetry.summary import Metric

if TYPE_CHECKING:
    from matplotlib.figure import Figure

C = TypeVar("C", bound=CaseConfig)
Changes = Mapping[str, Any]
"""nested, as `merged` takes them"""
Draws = Callable[[Any, "int | None"], Sequence[Changes]]
"""configuration of a row, requested number of seeds (None: the default) → changes of each run"""
_NONE: Mapping[str, Any] = {}


def once(base: CaseConfig, seeds: int | None) -> Sequence[Changes]:
    """One run, of the case's own seed."""
    return [{}]


def seeded(usual: int) -> Draws:
    """Runs that differ in their seed alone, from the case's own on."""

    def draws(base: CaseConfig, seeds: int | None) -> Sequence[Changes]:
        return [{"seed": base.seed + place} for place in range(seeds or usual)]

    return draws


@dataclass(frozen=True)
class Row:
    """One row of a case's table: its changes, its label, and its place in a figure."""

    label: str = ""
    """distinguishes rows of one controller; it is a name and is not parsed"""
    controller: str | None = None
    """None: the case's"""
    changes: Changes | Callable[[Any], Changes] = field(default_factory=dict[str, Any])
    """of the case's configuration, or how they follow from it"""
    value: float | None = None
    """value of the row on the axis of the case's figure; None: it is not in the figure"""
    group: tuple[str, ...] = ()
    """which of several curves of the figure the row belongs to"""
    paper: Mapping[str, float] = field(default_factory=dict[str, float])
    """metric → the number that the paper prints"""
    targets: Mapping[str, float] = field(default_factory=dict[str, float])
    """metric → its bound"""
    draws: Draws | None = None
    """None: the case's"""
    shown: bool | None = None
    """whether its first run keeps its log and gets figures; None: only if it has no label"""

    def changed(self, base: CaseConfig) -> Changes:
        """The changes of the row, for the present configuration of a case."""
        own = self.changes(base) if callable(self.changes) else self.changes
        return own if self.controller is None else {**own, "controller": self.controller}


@dataclass(frozen=True)
class Pair:
    """A metric of two rows together: run by run, with the same controller and seed, one row's value minus the other's.

    Runs whose partner is missing or failed are left out.
    """

    name: str
    metric: str
    """of both rows"""
    label: str
    """label of the row in which it is shown"""
    against: str
    """label of the other row"""
    absolute: bool = False
    paper: Mapping[str, float] = field(default_factory=dict[str, float])
    """controller → the number that the paper prints"""
    targets: Mapping[str, float] = field(default_factory=dict[str, float])
    """controller → bound"""

    def metrics(self, here: Sequence[Result], there: Sequence[Result]) -> list[Metric]:
        """One value per pair of runs of one controller; failed runs have none."""
        partners = {run.config.seed: run for run in there if run.failure is None}
        found: list[Metric] = []
        for run in here:
            partner = partners.get(run.config.seed)
            values = [_named(run, self.metric), None if partner is None else _named(partner, self.metric)]
            if run.failure is not None or values[0] is None or values[1] is None:
                continue
            difference = values[0].value - values[1].value
            found.append(
                Metric(
                    self.name,
                    abs(difference) if self.absolute else difference,
                    values[0].unit,
                    self.paper.get(run.config.controller),
                    self.targets.get(run.config.controller),
                )
            )
        return found


@dataclass(frozen=True)
class PaperTable:
    """A table as in the paper: a line per metric, a column per controller, the paper's numbers next to ours."""

    title: str
    metrics: Mapping[str, str]
    """name → heading"""
    label: str = ""
    """labels of its rows"""


@dataclass(frozen=True)
class Case(Generic[C]):
    """A case: everything that defines it, in one place."""

    config: C
    """the configuration that `pliant run` uses"""
    rows: Sequence[Row] = (Row(),)
    """of the full study"""
    draws: Draws = once
    judged: str | None = None
    """the controller that `targets` are for; None: any"""
    paper: Mapping[str, float] = field(default_factory=dict[str, float])
    """metric → the number that the paper prints, whatever the row"""
    targets: Mapping[str, float] = field(default_factory=dict[str, float])
    """metric → its bound, in every row of the controller that is judged"""
    alone: str = ""
    """label of the row whose numbers are shown with a single run of the case"""
    pairs: Sequence[Pair] = ()
    tables: Sequence[PaperTable] = ()
    figures: Sequence[Callable[[Case[Any], Sequence[Result]], Mapping[str, Figure]]] = ()
    """case, its results → name of a file → figure"""

    def row_of(self, config: CaseConfig) -> Row | None:
        """The row that a run belongs to; None if it belongs to none."""
        for label in (config.variant, self.alone) if not config.variant else (config.variant,):
            named = [row for row in self.rows if row.label == label]
            for controller in (config.controller, None):
                for row in named:
                    if row.controller == controller:
                        return row
        return None

    def beside(self, config: CaseConfig, metrics: Sequence[Metric]) -> tuple[Metric, ...]:
        """The metrics of a run, completed by the paper's numbers and the targets."""
        row = self.row_of(config)
        judged = self.judged in (None, config.controller)
        paper = {**self.paper, **(row.paper if row else _NONE)}
        targets = {**(self.targets if judged else _NONE), **(row.targets if row else _NONE)}
        return tuple(
            replace(
                metric,
                paper=paper.get(metric.name) if metric.paper is None else metric.paper,
                target=targets.get(metric.name) if metric.target is None else metric.target,
            )
            for metric in metrics
        )


def row_runs(base: C, row: Row, draws: Draws, seeds: int | None) -> list[C]:
    """Every run of one row, for the present configuration of a case."""
    config = merged(base, {**row.changed(base), "variant": row.label})
    return [merged(config, changes) for changes in (row.draws or draws)(base, seeds)]


def _named(result: Result, name: str) -> Metric | None:
    return next((metric for metric in result.metrics if metric.name == name), None)
