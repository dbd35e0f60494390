"""Searches a controller's parameters with optuna, in batches, so that the result does not depend on the workers."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import islice
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from pliant.configuration import merged
from pliant.errors import ConfigError, MissingExtraError, options
from pliant.experiments.base import CaseConfig, Result, Study
from pliant.experiments.parameter_search import ParameterSearch
from pliant.experiments.pool import Pool, in_this_process
from pliant.experiments.results import key
from pliant.experiments.sweep import sweep

if TYPE_CHECKING:
    import optuna

BATCH = 8
"""parameter sets per batch. It is fixed, so that the search does not depend on the number of processes"""
_UNCHANGED: Mapping[str, Any] = MappingProxyType({})


@dataclass(frozen=True)
class Trial:
    """One set of parameters and how good it is."""

    number: int
    values: Mapping[str, float]
    objective: float
    """lower is better"""
    failed: int
    """number of runs that did not reach their end"""
    failure: str | None = None
    """failure of the first of them"""


def find_search(
    study: Study[Any], controller: str, case: str | None = None, changes: Mapping[str, Any] = _UNCHANGED
) -> ParameterSearch:
    """How a controller of a study is tuned for a case. Args: changes: of the case, another robot for example.

    Raises:
        ConfigError: the study has no such controller or case, or does not say how it is tuned.
    """
    if ":" not in controller and controller not in study.controllers:  # a user's own class is found by `search`
        raise ConfigError(
            f"study {study.name!r} has no controller {controller!r}; {options(study.controllers, controller)}"
        )
    return study.changed_search(controller, case, changes)


def search(
    study: str, sought: ParameterSearch, trials: int, *, seed: int = 0, pool: Pool = in_this_process
) -> Iterator[Trial]:
    """Tries sets of parameters and yields each, in order; the first is the start.

    Args:
        study: name of the study that the runs belong to.
        sought: definition of the search.
        trials: how many sets.
        seed: of the search.
        pool: where the runs are made; the trials do not depend on it.

    Raises:
        MissingExtraError: optuna is not installed.
        ConfigError: the start itself is not a valid configuration.
    """
    _configured(sought, sought.start)
    sampler = _sampler(sought, seed)
    space = _space(sought)
    for first in range(0, trials, BATCH):
        asked = [sampler.ask(space) for _ in range(min(BATCH, trials - first))]
        for trial, tried in zip(asked, _tried(study, sought, asked, pool), strict=True):
            sampler.tell(trial, tried.objective)
            yield tried


def _tried(study: str, sought: ParameterSearch, asked: Sequence[optuna.Trial], pool: Pool) -> list[Trial]:
    """A batch: all runs of all its trials in parallel."""
    possible: dict[int, list[CaseConfig]] = {}
    refused: dict[int, str] = {}
    for trial in asked:
        try:
            possible[trial.number] = _configured(sought, trial.params)
        except ConfigError as error:  # values that do not fit together
            refused[trial.number] = str(error)
    # two trials may want the same run: the start can be sampled again
    wanted = {key(config): config for configs in possible.values() for config in configs}
    made = {key(run.result.config): run.result for run in sweep(study, list(wanted.values()), pool=pool)}
    return [
        _judged(sought, trial, _refused(sought, refused[trial.number]))
        if trial.number in refused
        else _judged(sought, trial, [made[key(config)] for config in possible[trial.number]])
        for trial in asked
    ]


def _refused(sought: ParameterSearch, reason: str) -> list[Result]:
    return [Result(config, (), reason) for config in sought.runs]


def _judged(sought: ParameterSearch, trial: optuna.Trial, results: Sequence[Result]) -> Trial:
    failures = [result.failure for result in results if result.failure is not None]
    return Trial(
        trial.number, dict(trial.params), sought.judge(results), len(failures), next(islice(failures, 1), None)
    )


def _configured(sought: ParameterSearch, values: Mapping[str, float]) -> list[CaseConfig]:
    changes = sought.changes(values)
    return [merged(config, changes) for config in sought.runs]


def _sampler(sought: ParameterSearch, seed: int) -> optuna.Study:
    optuna = require_optuna()
    optuna.logging.set_verbosity(optuna.logging.ERROR)
    sampler = optuna.samplers.TPESampler(seed=seed, multivariate=True, constant_liar=True)
    made: optuna.Study = optuna.create_study(sampler=sampler, direction="minimize")
    made.enqueue_trial(dict(sought.start))
    return made


def _space(sought: ParameterSearch) -> dict[str, Any]:
    optuna = require_optuna()
    return {
        name: optuna.distributions.FloatDistribution(range_.low, range_.high, log=range_.log)
        for name, range_ in sought.parameters.items()
    }


def require_optuna() -> Any:
    """The module. Raises MissingExtraError if it is not installed."""
    try:
        import optuna
    except ImportError as error:
        raise MissingExtraError("--tune needs optuna, which is not installed: pip install 'pliant[tune]'") from error
    return optuna
