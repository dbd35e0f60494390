"""The file `results.parquet` of a sweep: one row per run, written while the sweep goes on."""

from __future__ import annotations

import json
import math
import threading
import time
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

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
_PAUSE = 1.0  # s between two writings: a thousand short runs must not write the file a thousand times


@dataclass(frozen=True)
class Run:
    """One run of a sweep: what came out of it, and how it went."""

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
    """What the user asked for; kept in the file so that a sweep can be resumed from the file alone."""

    study: str
    cases: tuple[str, ...] = ()
    """empty: all"""
    seeds: int | None = None
    """per case with random draws; None: as many as the study deems enough"""
    assignments: tuple[str, ...] = ()
    """`key=value`"""
    logs: bool = False
    """whether every run keeps its log"""


class ResultStore:
    """Keeps the runs of a sweep in `results.parquet`. A context manager: what was added is in the file at its end.

    The file is written at most once a second, by a timer if no further run comes, so that a killed process loses at
    most the last second.
    """

    def __init__(self, folder: Path, request: Request, asked: Sequence[CaseConfig]) -> None:
        """
        Args:
            folder: where the file goes; one that is there and is not gone on with is kept as `results.parquet.old`.
            request: what was asked for.
            asked: every run of the sweep, in the order of the rows.
        """
        self.path = folder / FILE
        self._request = request
        self._place = {key(config): index for index, config in enumerate(asked)}
        self._runs: dict[int, Run] = {}
        self._lock = threading.Lock()
        self._written = -math.inf
        self._timer: threading.Timer | None = None

    @property
    def runs(self) -> list[Run]:
        """What was added, in the order in which it was asked for."""
        return [self._runs[place] for place in sorted(self._runs)]

    def __enter__(self) -> ResultStore:
        if not self._runs and _holds_rows(
            self.path
        ):  # a study that is started anew must not eat what an earlier one found
            self.path.replace(self.path.with_suffix(".parquet.old"))
        self.flush()  # even a sweep that is interrupted before its first result can be resumed
        return self

    def __exit__(self, *_: object) -> None:
        if self._timer is not None:
            self._timer.cancel()
        self.flush()

    def add_before(self, runs: Iterable[Run]) -> None:
        """Adds runs of an earlier sweep, without writing the file."""
        with self._lock:
            self._runs |= {self._place[key(run.result.config)]: run for run in runs}

    def add(self, run: Run) -> None:
        """Adds a run; it is in the file within a second. Raises OutputError if it cannot be written."""
        self.add_before([run])
        left = self._written + _PAUSE - time.monotonic()
        if left <= 0.0:
            self.flush()
        elif self._timer is None or not self._timer.is_alive():
            self._timer = threading.Timer(left, self._flush_later)
            self._timer.daemon = True
            self._timer.start()

    def flush(self) -> None:
        """Writes the file now. Raises OutputError if it cannot be written."""
        with self._lock:
            self._written = time.monotonic()
            rows = [_row(self._request.study, run, self.path.parent) for run in self.runs]
            write_parquet(self.path, _table(rows), asdict(self._request))

    def _flush_later(self) -> None:
        try:
            self.flush()
        except OutputError:
            self._written = -math.inf  # the next `add`, or the end, tries again where the error is seen


def _holds_rows(path: Path) -> bool:
    """Whether there is a file that somebody may want back; one that cannot be read counts."""
    if not path.exists():
        return False
    try:
        return read_parquet(path)[0].num_rows > 0
    except OutputError:
        return True


def key(config: CaseConfig) -> str:
    """What makes a run the same run: its whole configuration."""
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
        about |= {name: tuple(about[name]) for name in ("cases", "assignments")}
        request = Request(**about)
        kind = type(next(iter(get_study(request.study).cases.values())))
        return request, [_run(row, kind, path.parent) for row in table.to_pylist()]
    except (KeyError, TypeError, ValueError, ConfigError) as error:
        raise OutputError(f"{path} does not hold the results of a study ({type(error).__name__}: {error})") from None


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
    exact = {"metrics": [asdict(metric) | {"value": _text(metric.value)} for metric in result.metrics], **files}
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
    exact = json.loads(row["result"])
    metrics = tuple(Metric(**metric | {"value": float(metric["value"])}) for metric in exact["metrics"])
    log = None if exact["log"] is None else folder / exact["log"]
    figures = tuple(folder / name for name in exact["figures"])
    config = kind.model_validate_json(row["configuration"])
    result = Result(config, metrics, row["failure"], tuple(row["warnings"]), log, figures)
    return Run(result, row["status"], row["wall [s]"])


def _column(metric: Metric) -> str:
    return f"{metric.name} [{metric.unit or '1'}]"


def _text(value: float) -> float | str:
    """JSON has no NaN and no infinity: both become text, which `float` reads."""
    return float(value) if math.isfinite(value) else str(float(value))


def _inside(path: Path | None, folder: Path) -> str | None:
    """A path as the folder knows it, so that the folder can be moved."""
    if path is None:
        return None
    whole, root = path.resolve(), folder.resolve()
    return str(whole.relative_to(root) if whole.is_relative_to(root) else whole)


def unsettled(asked: Iterable[CaseConfig], runs: Iterable[Run]) -> list[CaseConfig]:
    """The runs that are still to be made."""
    done = {key(run.result.config) for run in runs if run.settled}
    return [config for config in asked if key(config) not in done]
