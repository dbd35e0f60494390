"""The command line: `pliant run`, `study`, `live`, `log`, `bench`, `list`, `doctor`, …"""

from __future__ import annotations

import gc
from typing import Annotated

import typer

from pliant import __version__
from pliant.cli import running, tools  # each module registers its commands
from pliant.cli.program import app, out

_YOUNG = 100_000  # objects between two searches for cycles; Python's 700 search hundreds of times in what imports make

__all__ = ["app", "main", "running", "tools"]


def _version(show: bool) -> None:
    if show:
        out.print(f"pliant {__version__}")
        raise typer.Exit


@app.callback()
def _root(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Prints the version.")
    ] = False,
) -> None:
    pass


def main() -> None:
    """Entry point."""
    gc.set_threshold(_YOUNG, 20, 20)
    app()
