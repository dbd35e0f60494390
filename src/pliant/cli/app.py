"""The command line: `pliant run`, `study`, `live`, `log`, `bench`, `list`, `doctor`, …"""

from __future__ import annotations

from typing import Annotated

import typer

from pliant import __version__
from pliant.cli import running, tools  # each module registers its commands
from pliant.cli.program import app, out

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
    app()
