"""`pliant log`: what is in a log."""

from __future__ import annotations

from pathlib import Path

from rich.console import Console

from pliant.telemetry.describe import describe
from pliant.telemetry.log import Log
from pliant.telemetry.plots import plot_log


def log_command(console: Console, file: Path, plot: bool, out: Path | None) -> None:
    """Prints channels, rates and metrics of a log; draws it on request.

    Raises:
        OutputError: the file cannot be read, or a figure cannot be written.
    """
    log = Log.open(file)
    console.print(describe(log))
    if log.truncated:
        console.print("the log is cut off or damaged: what is shown is what could be read", style="yellow")
    if plot:
        for figure in plot_log(log, out or file.with_suffix("")):
            console.print(f"figure  {figure}", markup=False, highlight=False, soft_wrap=True)
