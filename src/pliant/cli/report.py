"""Results in the terminal, and their files."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from rich.console import Console

from pliant.experiments.base import Result, Study
from pliant.experiments.summarise import summarised
from pliant.telemetry.table import summary_table


def save_summary(study: Study[Any], results: Sequence[Result], folder: Path) -> Path:
    """Writes summary.json. Returns the file."""
    return summarised(study, results).write(folder)


def print_results(console: Console, study: Study[Any], results: Sequence[Result]) -> None:
    """Prints the metrics with the paper's numbers and the targets."""
    console.print(summary_table(summarised(study, results)))
