"""`pliant live`: the page of a running case, or the replay of a log."""

from __future__ import annotations

import importlib.util
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from rich.console import Console

from pliant.cli.choose import resolve
from pliant.errors import MissingExtraError

DEFAULT_HOST, DEFAULT_PORT = "127.0.0.1", 8080


def live_command(
    console: Console,
    complain: Console,
    target: str,
    case: str | None,
    overrides: Mapping[str, Any],
    assignments: Sequence[str],
    host: str,
    port: int,
    out: Path | None,
) -> None:
    """Serves the page until Ctrl-C.

    Raises:
        PliantError: bad input, or an address at which the server cannot listen.
    """
    require_viser()
    if target.endswith(".mcap"):
        from pliant.live.page.replay import serve_replay

        serve_replay(Path(target), host, port, lambda server: announce(console, complain, server.url, server.exposed))
        return
    from pliant.live.server.launch import serve_live

    choice = resolve(target, case, overrides, assignments)
    folder = out or Path("pliant-out") / "live"
    try:
        serve_live(
            choice.study.name,
            choice.config,
            host,
            port,
            folder,
            lambda server: announce(console, complain, server.url, server.exposed),
        )
    except KeyboardInterrupt:
        console.print("\nthe page is closed")


def announce(console: Console, complain: Console, url: str, exposed: bool) -> None:
    """Prints the address of the page, with a warning if other machines can reach it."""
    if exposed:
        text = "warning: other machines can reach this page; whoever has the link can steer, and nothing is encrypted"
        complain.print(text, style="yellow", markup=False, highlight=False, soft_wrap=True)
    console.print(f"open  {url}\nstop  Ctrl-C", markup=False, highlight=False, soft_wrap=True)


def require_viser() -> None:
    """Raises MissingExtraError if the page's server is not installed."""
    if importlib.util.find_spec("viser") is None:
        raise MissingExtraError("the live page needs viser, which is not installed: pip install 'pliant[live]'")
