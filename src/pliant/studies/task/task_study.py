"""A task file as a study: its variants are the cases, its `[sweep]` the rows."""

from __future__ import annotations

import itertools
from abc import abstractmethod
from collections.abc import Mapping, Sequence
from typing import Any, cast

from pliant.configuration import merged
from pliant.dotted import flat, nested
from pliant.errors import ConfigError
from pliant.experiments.base import Study
from pliant.experiments.case import Case, Row, once, row_runs, seeded
from pliant.experiments.parameter_search import ParameterSearch
from pliant.experiments.sensing import noise_of
from pliant.overlay import overlaid
from pliant.references.reach.check import ReachCheck
from pliant.rules import Suggestion
from pliant.studies.task.check import CHECKED_DRAWS
from pliant.studies.task.config import TaskCase
from pliant.studies.task.search import Searched, search_of
from pliant.tasks.timing import TimingConfig
from pliant.wiring.noise import Noise, suited_to_noise
from pliant.wiring.registry import find_controller

_SEEDS = 3


class TaskStudy(Study[TaskCase]):
    """Runs of one task, whatever its kind.

    Args:
        name: of the task: its file or its name in the catalogue.
        cases: name → run; the first is the task itself, the others are its variants.
    """

    def __init__(self, name: str, cases: Mapping[str, TaskCase]) -> None:
        self.name = name
        self.cases = {case: Case(config, (), _draws) for case, config in cases.items()}
        self.title = next(iter(cases.values())).description or "a contact task"

    def rows(self, base: TaskCase) -> Sequence[Row]:
        """Every combination of the values of `[sweep]`."""
        sweep = {key: values for key, values in base.sweep.items() if key != "seeds"}
        for key, values in sweep.items():
            _refuse_no_list(key, values)
        rows: list[Row] = []
        for values in itertools.product(*sweep.values()):
            changes: dict[str, Any] = {}
            named: list[str] = []
            for key, value in zip(sweep, values, strict=True):
                label, own = _of_a_value(key, value)
                changes = overlaid(None, changes, own)
                named += [] if key == "controller" else [f"{key} {label}"]
            controller = changes.pop("controller", None)
            rows.append(Row(", ".join(named), controller, changes))
        return rows

    def note(self, config: TaskCase) -> str:
        if config.sweep.keys() - {"seeds"}:
            return ""
        return f"{config.case} has no [sweep] of keys: it is run as it is, once for each seed"

    def shows(self, config: TaskCase) -> bool:
        return config.seed == 0

    def search(self, controller: str, case: str | None = None) -> ParameterSearch:
        return self.changed_search(controller, case, {})

    def changed_search(self, controller: str, case: str | None, changes: Mapping[str, Any]) -> ParameterSearch:
        config = merged(self.case(case or next(iter(self.cases))), {**changes, "controller": controller})
        return search_of(config, self.searched(config))

    def suggested(self, config: TaskCase) -> Mapping[str, Suggestion]:
        """What the assumed noise suggests for the estimators that the controller has."""
        known = self.searched(config)
        entry = find_controller(config.controller)
        needs = entry.needs(config.controller_parameters(known.robot, known.believed))
        suits = suited_to_noise(noise_of(config.estimation), known.robot)
        used = {"estimation.joint_memory": needs.calm, "estimation.observer_gain": needs.disturbance != "none"}
        return {key: one for key, one in suits.items() if used[key]}

    @abstractmethod
    def searched(self, config: TaskCase) -> Searched:
        """What a search over the controller's parameters starts from."""

    def about(self, config: TaskCase) -> Mapping[str, str]:
        """What → what is to be known of it before a run, in a sentence each."""
        timing, noise = config.timing, noise_of(config.estimation)
        told = {
            f"readings {1e3 * timing.sensing_delay:g} ms old": timing.sensing_delay == TimingConfig().sensing_delay,
            f"commands that act after {1e3 * timing.computation_delay:g} ms": (
                timing.computation_delay == TimingConfig().computation_delay
            ),
            f"noise of {noise.position:g} rad, {noise.velocity:g} rad/s, {noise.force:g} N": noise == Noise(),
        }
        assumed = [text for text, usual in told.items() if usual]
        return {"assumed": ", ".join(assumed) + " (timing, estimation: measure yours)"} if assumed else {}

    def refuse_unknown(self, config: TaskCase) -> None:
        """Raises ConfigError for names that a run or a row of `[sweep]` would refuse: of controllers, metrics, keys."""
        for row in self.rows(config):
            for run in row_runs(config, row, once, None):
                find_controller(run.controller)
                self.check_accept(run)

    @abstractmethod
    def check_accept(self, config: TaskCase) -> None:
        """Raises ConfigError for a metric of `accept` that there is not."""

    @abstractmethod
    def check(self, config: TaskCase, drawn: int = CHECKED_DRAWS) -> ReachCheck:
        """Reach, limits, freedom, torque and speed along the whole task. Args: drawn: how many drawn worlds.

        Raises:
            PliantError: a robot, frame or path that there is not.
        """


def _refuse_no_list(key: str, values: Any) -> None:
    """Raises ConfigError unless there are values to sweep over."""
    if isinstance(values, Mapping) and values:
        inner = next(iter(flat({key: values})))
        raise ConfigError(f'sweep.{key} is a table: write "{inner}" in quotes, "{inner}" = [ … ]')
    if not isinstance(values, list | tuple):
        raise ConfigError(f"sweep.{key}: a list of values, got {values!r}")
    if not values:
        raise ConfigError(f"sweep.{key} is an empty list: give it a value, or leave the key out")


def _of_a_value(key: str, value: Any) -> tuple[str, dict[str, Any]]:
    """What a value of a sweep is called and what it changes: its key, or all that a table says beside its label."""
    if not isinstance(value, Mapping):
        return str(value), nested({key: value})
    changes = dict(cast("Mapping[str, Any]", value))
    label = changes.pop("label", None)
    if not isinstance(label, str) or not changes:
        raise ConfigError(
            f"sweep.{key}: a table that changes several values has a label: {{ label = 'soft', … }}, got {value!r}"
        )
    return label, nested(changes)


def _draws(base: TaskCase, seeds: int | None) -> Sequence[Mapping[str, Any]]:
    return seeded(int(base.sweep.get("seeds", _SEEDS)))(base, seeds)
