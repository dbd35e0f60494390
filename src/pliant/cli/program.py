"""The program `pliant`: its consoles, and the options that several commands share."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

app = typer.Typer(
    name="pliant",
    help="Contact control for torque-controlled robots: run a contact task, see it, measure it.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)
out = Console()
err = Console(stderr=True)

Out = Annotated[Path | None, typer.Option("--out", help="Folder for logs, figures and summary.json.")]
Sets = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="KEY=VALUE", help="Overrides one value, e.g. seed=3; repeatable; see --show-config."),
]
Controller = Annotated[
    str | None,
    typer.Option(
        metavar="NAME|MODULE:CLASS|FILE.py:CLASS", help="Controller by name, see `pliant list controllers`, or yours."
    ),
]
Metrics = Annotated[
    list[str] | None,
    typer.Option(
        "--metric",
        metavar="MODULE:FUNCTION|FILE.py:FUNCTION",
        help="One more metric, a function (log, config) -> pliant.Metric; repeatable.",
    ),
]
RobotOption = Annotated[
    str | None, typer.Option("--robot", metavar="NAME|FILE", help="Catalogue name, or a URDF or MJCF file.")
]
Seed = Annotated[int | None, typer.Option(min=0, help="Seed of every random draw.")]
