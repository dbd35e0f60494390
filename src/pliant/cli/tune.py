"""`pliant study NAME --tune CONTROLLER`: searches the controller's parameters, and writes the best as TOML."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console
from rich.table import Table

from pliant import __version__
from pliant.cli.choose import study_folder
from pliant.cli.progress import count_bar
from pliant.configuration import merged
from pliant.experiments.config import assigned
from pliant.experiments.lock import locked
from pliant.experiments.open_pool import open_pool
from pliant.experiments.parameter_search import PENALTY, ParameterSearch
from pliant.experiments.parquet import write_parquet
from pliant.experiments.registry import get_study
from pliant.experiments.search import Trial, find_search, require_optuna, search
from pliant.experiments.sweep import check_buildable
from pliant.telemetry.output import output_folder, write_text
from pliant.telemetry.table import number


def tune_command(
    console: Console,
    complain: Console,
    name: str,
    controller: str,
    case: str | None,
    trials: int,
    seed: int,
    assignments: Sequence[str],
    out: Path | None,
    jobs: int,
    scheduler: str | None,
) -> None:
    """Searches; after Ctrl-C the best trial so far is kept.

    Raises:
        PliantError: bad input; nothing was run.
    """
    require_optuna()
    sought = find_search(get_study(name), controller, case, assigned(assignments))
    check_buildable(name, merged(sought.runs[0], sought.changes(sought.start)))
    folder = output_folder(out or study_folder(f"{Path(name).stem}-tune-{re.sub(r'[^A-Za-z0-9_-]+', '-', controller)}"))
    made: list[Trial] = []
    about = {"study": name, "controller": controller, "case": case, "seed": seed, "assignments": list(assignments)}
    with locked(folder):
        try:
            with open_pool(jobs, scheduler) as pool, count_bar(complain, f"tune {name} {controller}", trials) as step:
                for trial in search(name, sought, trials, seed=seed, pool=pool):
                    made.append(trial)
                    step(trial.failed > 0)
        except KeyboardInterrupt:
            raise KeyboardInterrupt(f"the best of {len(made)} of {trials} trials is kept in {folder}") from None
        finally:
            if made:
                _finish(console, sought, made, about, folder)


def _finish(
    console: Console, sought: ParameterSearch, made: Sequence[Trial], about: Mapping[str, Any], folder: Path
) -> None:
    table = folder / "trials.parquet"
    _write_trials(table, sought, made, about)
    best = min(made, key=lambda trial: trial.objective)  # the first of equal trials: the start, if no other is better
    toml = folder / "tuned.toml"
    write_text(toml, _toml(sought, made, best, about))
    figure = _draw(sought, made, about, folder / "trials.png")
    console.print(_start_and_best(sought, made, best, about))
    console.print(compared_to_start(made[0], best), markup=False, highlight=False, soft_wrap=True)
    for kind, path in (("tuned", toml), ("trials", table), ("figure", figure)):
        console.print(f"{kind:8s} {path}", markup=False, highlight=False, soft_wrap=True)


def _write_trials(path: Path, sought: ParameterSearch, made: Sequence[Trial], about: Mapping[str, Any]) -> None:
    import pyarrow as pa

    columns: dict[str, Any] = {
        "trial": pa.array([trial.number for trial in made], pa.int64()),
        "objective": pa.array([trial.objective for trial in made], pa.float64()),
        "failed": pa.array([trial.failed for trial in made], pa.int64()),
        "failure": pa.array([trial.failure for trial in made], pa.string()),
    }
    columns |= {name: pa.array([trial.values[name] for trial in made], pa.float64()) for name in sought.parameters}
    write_parquet(path, pa.table(columns), about)


def _start_and_best(sought: ParameterSearch, made: Sequence[Trial], best: Trial, about: Mapping[str, Any]) -> Table:
    title = f"{about['study']} · {about['controller']} · pliant {__version__} · best of {len(made)} trials"
    table = Table(title=title, title_justify="left", title_style="bold", header_style="bold")
    table.add_column("parameter", overflow="fold")
    for heading in ("start", "best", "searched"):
        table.add_column(heading, justify="right", no_wrap=True)
    for name, range_ in sought.parameters.items():
        searched = f"{number(range_.low)} … {number(range_.high)}"
        table.add_row(name, number(sought.start[name]), number(best.values[name]), searched)
    table.add_section()
    table.add_row("objective", _objective(made[0]), _objective(best), "")
    return table


def compared_to_start(start: Trial, best: Trial) -> str:
    """In one sentence, whether the search improved the parameters that it started from."""
    if start.failed > best.failed:
        return f"Better than the start: {best.failed} failed runs in place of {start.failed}."
    if best.objective < start.objective:
        return f"Better than the start: the objective fell from {number(start.objective)} to {number(best.objective)}."
    return "Not better than the start: no trial had a lower objective than the parameters the search started from."


def _objective(trial: Trial) -> str:
    return f"{trial.failed} failed" if trial.failed else number(trial.objective)


def _draw(sought: ParameterSearch, made: Sequence[Trial], about: Mapping[str, Any], path: Path) -> Path:
    from pliant.telemetry.plots import save
    from pliant.telemetry.plots import trials as draw

    judged = np.array([np.nan if trial.objective >= PENALTY or trial.failed else trial.objective for trial in made])
    values = {name: np.array([trial.values[name] for trial in made]) for name in sought.parameters}
    log = [name for name, range_ in sought.parameters.items() if range_.log]
    return save(draw(judged, values, log, f"Search · {about['study']} · {about['controller']}"), path)


def _toml(sought: ParameterSearch, made: Sequence[Trial], best: Trial, about: Mapping[str, Any]) -> str:
    lines = [
        f"# pliant {__version__}: best of {len(made)} trials, seed {about['seed']};"
        f" objective {_objective(best)}, at the start {_objective(made[0])}",
        f"study = {json.dumps(about['study'])}",
        *([] if about["case"] is None else [f"case = {json.dumps(about['case'])}"]),
        f"controller = {json.dumps(about['controller'])}",
        *_assignments(sought.changes(best.values)),
    ]
    return "\n".join(lines) + "\n"


def _assignments(tree: Mapping[str, Any], above: str = "") -> list[str]:
    """Dotted keys: TOML has them, and they read like `--set`."""
    lines: list[str] = []
    for name, value in tree.items():
        key = above + (name if re.fullmatch(r"[A-Za-z0-9_-]+", name) else json.dumps(name))
        if isinstance(value, Mapping):
            lines += _assignments(value, f"{key}.")
        elif value is not None:  # TOML has no null
            lines.append(f"{key} = {_value(value)}")
    return lines


def _value(value: Any) -> str:
    if isinstance(value, (list, tuple, np.ndarray)):
        return "[" + ", ".join(_value(entry) for entry in value) + "]"
    if isinstance(value, (float, np.floating)):
        return repr(float(value))
    return json.dumps(value.item() if isinstance(value, np.generic) else value, ensure_ascii=False)
