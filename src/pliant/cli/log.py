"""`pliant log`: what is in a log, and logs for other tools."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from rich.console import Console

from pliant.errors import ConfigError
from pliant.experiments.animation import animate
from pliant.telemetry.describe import describe
from pliant.telemetry.lerobot import ACTION, export_lerobot
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
        console.print("the log is truncated or damaged: only what could be read is shown", style="yellow")
    if plot:
        for figure in plot_log(log, out or file.with_suffix("")):
            console.print(f"figure  {figure}", markup=False, highlight=False, soft_wrap=True)


def export_command(console: Console, files: Sequence[Path], folder: Path, fps: int, action: str | None) -> None:
    """Writes logs as a LeRobot data set. Args: action: channels, separated by commas; None: the torque.

    Raises:
        ConfigError: the logs do not fit together, or a channel does not exist.
        OutputError: a file cannot be read or written.
    """
    channels = ACTION if action is None else tuple(part.strip() for part in action.split(",") if part.strip())
    logs = [Log.open(file) for file in files]
    export_lerobot(logs, folder, fps=fps, action=channels)
    console.print(f"LeRobot data set of {len(logs)} episodes  {folder}", markup=False, highlight=False, soft_wrap=True)


def animate_command(console: Console, files: Sequence[Path], out: Path | None) -> None:
    """Makes an animated picture of a log. Args: out: .webp or .gif; None: beside the log.

    Raises:
        ConfigError: more than one log, or another ending.
        OutputError: a file cannot be read or written, or there is nothing to draw.
    """
    if len(files) != 1:
        raise ConfigError(f"pliant log animate takes one log, got {len(files)}")
    made = animate(Log.open(files[0]), out or files[0].with_suffix(".webp"))
    size = made.stat().st_size / 1e6
    console.print(f"picture  {made}  ({size:.2f} MB)", markup=False, highlight=False, soft_wrap=True)
