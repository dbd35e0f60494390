"""The file `results.parquet` of a sweep: one row per run, written while the sweep goes on."""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, get_args

from pydantic import TypeAdapter

from pliant import __version__
from pliant.errors import ConfigError, OutputError
from pliant.experiments.base import CaseConfig, Result
from pliant.experiments.parquet import read_parquet, write_parquet
from pliant.experiments.registry import get_study
from pliant.telemetry.summary import Metric

if TYPE_CHECKING:
    import pyarrow as pa

FILE = "results.parquet"
Status = Literal["finished", "failed", "crashed", "lost"]
"""failed: by physics; crashed: an exception stopped it; lost: its process died again and again"""
_NAMES = ("case", "controller", "variant", "seed")
_METRICS = TypeAdapter(tuple[Metric, ...])


@dataclass(frozen=True)
class Run:
    """One run of a sweep: its result and status."""

    result: Result
    status: Status
    seconds: float
    """wall time"""

    @property
    def settled(self) -> bool:
        """Whether running it again would give the same: it reached its end, or physics stopped it."""
        return self.status in ("finished", "failed")


@dataclass(frozen=True)
class Request:
    """The requested sweep; stored in the file so that a sweep can be resumed from the file alone."""

    study: str
    cases: tuple[str, ...] = ()
    """empty: all"""
    seeds: int | None = None
    """per case with random draws; None: the study's default"""
    assignments: tuple[str, ...] = ()
    """`key=value`"""
    logs: bool = False
    """whether every run keeps its log"""
    controllers: tuple[str, ...] = ()
    """each runs every case with the same seeds; empty: those of the study"""


class ResultStore:
    """Keeps the runs of a sweep in `results.parquet`, which is written whole after every run: a command that is killed
    loses none that had ended."""

    def __init__(self, folder: Path, request: Request, asked: Sequence[CaseConfig]) -> None:
        """
        Args:
            folder: where the file goes; an existing file that is not continued is kept as `results.parquet.old`.
            request: what was asked for.
            asked: every run of the sweep, in the order of the rows.
        """
        self.path = folder / FILE
        self._request = request
        self._place = {key(config): index for index, config in enumerate(asked)}
        self._runs: dict[int, Run] = {}
        self._rows: dict[int, dict[str, Any]] = {}

    @property
    def runs(self) -> list[Run]:
        """The runs that were added, in the order of the request."""
        return [self._runs[place] for place in sorted(self._runs)]

    def begin(self) -> None:
        """Writes the file before the first run: so that a sweep that is interrupted early can be resumed as well.

        Raises:
            OutputError: it cannot be written.
        """
        if not self._runs and _holds_rows(self.path):  # a new start of a study must not destroy earlier results
            self.path.replace(self.path.with_suffix(".parquet.old"))
        self._write()

    def add_before(self, runs: Iterable[Run]) -> None:
        """Adds runs of an earlier sweep, without writing the file."""
        for run in runs:
            place = self._place[key(run.result.config)]
            self._runs[place], self._rows[place] = run, _row(self._request.study, run, self.path.parent)

    def add(self, run: Run) -> None:
        """Adds a run; it is in the file when this returns. Raises OutputError if it cannot be written."""
        self.add_before([run])
        self._write()

    def _write(self) -> None:
        write_parquet(self.path, _table([self._rows[place] for place in sorted(self._rows)]), asdict(self._request))


def _holds_rows(path: Path) -> bool:
    """Whether there is a file with results that may be needed; a file that cannot be read counts."""
    if not path.exists():
        return False
    try:
        return read_parquet(path)[0].num_rows > 0
    except OutputError:
        return True


def key(config: CaseConfig) -> str:
    """Key that identifies a run: its whole configuration."""
    return config.model_dump_json()


def read_results(path: Path) -> tuple[Request, list[Run]]:
    """Reads a `results.parquet`, or the one in a folder.

    Returns:
        What was asked for, and the runs that there are.

    Raises:
        OutputError: it does not exist, is damaged, or is not the result of a study.
        ConfigError: another version of pliant wrote it.
    """
    path = path / FILE if path.is_dir() else path
    table, about = read_parquet(path)
    version = about.pop("version")
    if version != __version__:
        raise ConfigError(
            f"{path} was written by pliant {version}, this is pliant {__version__}; results of two versions are not"
            " mixed: install that version, or start the study again"
        )
    try:
        about |= {name: tuple(about[name]) for name in ("cases", "assignments", "controllers")}
        request = TypeAdapter(Request).validate_python(about)
        kind = get_study(request.study).config_type
        return request, [_run(row, kind, path.parent) for row in table.to_pylist()]
    except Exception as error:  # an edited or damaged file may contain anything
        why = " ".join(str(error).split())
        raise OutputError(f"{path} does not hold the results of a study ({type(error).__name__}: {why})") from None


def _table(rows: Sequence[dict[str, Any]]) -> pa.Table:
    import pyarrow as pa

    texts = ("study", "case", "controller", "variant")
    fixed = [
        *((name, pa.string()) for name in texts),
        ("seed", pa.int64()),
        ("version", pa.string()),
        ("status", pa.string()),
        ("failure", pa.string()),
        ("warnings", pa.list_(pa.string())),
        ("wall [s]", pa.float64()),
        ("configuration", pa.string()),
        ("result", pa.string()),
    ]
    known = {name for name, _ in fixed}
    metrics = dict.fromkeys(name for row in rows for name in row if name not in known)
    return pa.Table.from_pylist(list(rows), pa.schema([*fixed, *((name, pa.float64()) for name in metrics)]))


def _row(study: str, run: Run, folder: Path) -> dict[str, Any]:
    result = run.result
    config = result.config
    files = {"log": _inside(result.log, folder), "figures": [_inside(figure, folder) for figure in result.figures]}
    about = [{**asdict(metric), "value": _column(metric)} for metric in result.metrics]  # each value is stored once
    exact = {"metrics": about, **files}
    columns = {_column(metric): metric.value for metric in result.metrics}
    return columns | {
        "study": study,
        "case": config.case,
        "controller": config.controller,
        "variant": config.variant,
        "seed": config.seed,
        "version": __version__,
        "status": run.status,
        "failure": result.failure,
        "warnings": list(result.warnings),
        "wall [s]": run.seconds,
        "configuration": key(config),
        "result": json.dumps(exact, ensure_ascii=False),
    }


def _run(row: dict[str, Any], kind: type[CaseConfig], folder: Path) -> Run:
    """May raise any error if a row is not as `_row` makes it."""
    exact = json.loads(row["result"])
    log = None if exact["log"] is None else folder / exact["log"]
    figures = tuple(folder / name for name in exact["figures"])
    config = kind.model_validate_json(row["configuration"])
    said, is_ = ([row[name] for name in _NAMES], [config.case, config.controller, config.variant, config.seed])
    if said != is_:
        raise ValueError(f"the row of {said} has the configuration of {is_}")
    if row["status"] not in get_args(Status) or (row["status"] == "finished") != (row["failure"] is None):
        raise ValueError(f"status {row['status']!r} with failure {row['failure']!r}")
    metrics = _METRICS.validate_python([about | {"value": row[about["value"]]} for about in exact["metrics"]])
    result = Result(config, metrics, row["failure"], tuple(row["warnings"]), log, figures)
    return Run(result, row["status"], float(row["wall [s]"]))


def _column(metric: Metric) -> str:
    return f"{metric.name} [{metric.unit or '1'}]"


def _inside(path: Path | None, folder: Path) -> str | None:
    """A path relative to the folder, so that the folder can be moved."""
    if path is None:
        return None
    whole, root = path.resolve(), folder.resolve()
    return str(whole.relative_to(root) if whole.is_relative_to(root) else whole)


def unsettled(asked: Iterable[CaseConfig], runs: Iterable[Run]) -> list[CaseConfig]:
    """The runs that are missing."""
    done = {key(run.result.config) for run in runs if run.settled}
    return [config for config in asked if key(config) not in done]
