"""`pliant.run` and `pliant.compare`."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from pliant.errors import ConfigError
from pliant.experiments.base import CaseConfig, Study, check_windows
from pliant.experiments.choice import chosen
from pliant.experiments.repeat import write_config
from pliant.experiments.runner import run_case
from pliant.experiments.sweep import compared, results_in_order
from pliant.face.changes import checked_changes
from pliant.face.result import Comparison, RunResult, save
from pliant.tasks.task import Task
from pliant.telemetry.log import Log
from pliant.telemetry.output import output_folder


def run(
    what: str | Path | Task,
    *,
    case: str | None = None,
    controller: str | None = None,
    robot: str | None = None,
    seed: int | None = None,
    metrics: Sequence[str] | None = None,
    out: str | Path | None = None,
    **changes: Any,
) -> RunResult:
    """Runs one case in simulation and measures it.

    Args:
        what: name of a study or a task, path of a TOML file, a `Task`, or `config.toml` or log of a run, which is
            repeated.
        case: of the study; None: its first.
        controller: name, `my_module:MyController` or `my_file.py:MyController`; None: the case's.
        robot: catalogue name, or path of a URDF or MJCF file; None: the case's.
        seed: of every random draw; None: the case's.
        metrics: of your own beside the study's, `my_module:metric` or `my_file.py:metric`.
        out: folder for log, figures, summary.json and config.toml; None: nothing is written.
        changes: other values of the configuration, nested: `duration=2.0`, `control={"horizon": 3}`, or with a
            dotted key `**{"control.horizon": 3}`.

    Returns:
        Metrics, log, table, figures. A run that failed says so in `failure` and raises nothing.

    Raises:
        PliantError: bad input, in one sentence; nothing was run.
    """
    overrides = {"controller": controller, "robot": robot, "seed": seed, "own_metrics": metrics}
    asked = chosen(_named(what), case, overrides, checked_changes(changes))
    study, config = asked.study, asked.config
    check_windows(config)
    if out is not None:
        return _kept(study, config, output_folder(Path(out)))
    with tempfile.TemporaryDirectory() as folder:
        found = run_case(study, config, Path(folder), figures=False)
        return RunResult(study, found, _log(found.log))


def compare(
    what: str | Path | Task,
    controllers: Sequence[str],
    *,
    case: str | None = None,
    robot: str | None = None,
    seeds: int = 1,
    metrics: Sequence[str] | None = None,
    jobs: int = 1,
    **changes: Any,
) -> Comparison:
    """Runs several controllers on the same case with the same seeds.

    Args:
        what: as of `run`.
        controllers: names, `my_module:MyController` or `my_file.py:MyController`.
        case: of the study; None: its first.
        robot: catalogue name, or path of a file; None: the case's.
        seeds: number of seeds, beginning with the case's own.
        metrics: of your own beside the study's.
        jobs: runs at the same time, each in a process of its own. Results do not depend on it.
        changes: as of `run`; the same for every controller.

    Returns:
        Metrics per controller; runs that failed are counted.

    Raises:
        PliantError: bad input, in one sentence; nothing was run.
    """
    if isinstance(controllers, str):
        raise ConfigError(f"a comparison takes a list of controllers, got the text {controllers!r}")
    if not controllers or seeds < 1:
        raise ConfigError(f"a comparison needs a controller and a seed, got {len(controllers)} and {seeds}")
    choice = chosen(_named(what), case, {"robot": robot, "own_metrics": metrics}, checked_changes(changes))
    study = choice.study
    asked = compared(choice.config, controllers, seeds)
    for config in asked[::seeds]:
        check_windows(config)
        study.build(config)  # errors of a controller are found before anything runs
    return Comparison(study, results_in_order(study.name, asked, jobs))


def _named(what: str | Path | Task) -> str | Task:
    return what if isinstance(what, Task) else str(what)


def _kept(study: Study[Any], config: CaseConfig, folder: Path) -> RunResult:
    write_config(study, config, folder)
    found = run_case(study, config, folder)
    result = RunResult(study, found, _log(found.log))
    save(result, folder)
    return result


def _log(path: Path | None) -> Log:
    assert path is not None  # a folder was given
    return Log.open(path)
