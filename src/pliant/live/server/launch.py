"""Starts page and loop, each in a process of its own."""

from __future__ import annotations

import multiprocessing
import signal
import time
from collections.abc import Callable, Generator
from contextlib import contextmanager
from multiprocessing.connection import Connection
from pathlib import Path
from types import FrameType

from pliant.errors import ConfigError, PliantError, RunFailedError
from pliant.experiments.base import CaseConfig
from pliant.live.link.pipe import Link
from pliant.live.loop.worker import main as run_worker
from pliant.live.page.page import Page
from pliant.live.server.web import PageServer

_PATIENCE = 10.0  # s for the other process to finish its log
_LAST_WORDS = 3.0  # s in which browsers are told that the loop has ended
_LOST = "the process of the loop has ended unexpectedly; start the command again"
Announce = Callable[[PageServer], None]
"""called with the address once the page can be opened"""


def serve_live(study: str, config: CaseConfig, host: str, port: int, folder: Path, announce: Announce) -> None:
    """Shows a study until the process is interrupted; its loop runs in a child process.

    Args:
        study: name of the study.
        config: case to begin with.
        host, port: where browsers connect.
        folder: where logs go.
        announce: told the address.

    Raises:
        ConfigError: the address cannot be listened at.
        RunFailedError: the process of the loop ended unexpectedly.
    """
    with PageServer(host, port) as server, live_page(server, folder) as page:
        page.run.start(study, config)
        announce(server)
        _serve_until_told(page)
        if page.lost:
            page.mourn(_LOST)
            time.sleep(_LAST_WORDS)
            raise RunFailedError(_LOST)


@contextmanager
def live_page(server: PageServer, folder: Path) -> Generator[Page]:
    """A page and the process of its loop, which waits for a first `Begin`."""
    context = multiprocessing.get_context("spawn")
    near, far = context.Pipe()
    child = context.Process(target=run_worker, args=(far,), name="pliant-loop", daemon=True)
    child.start()
    far.close()
    link = Link(near)
    try:
        yield Page(server, link, folder)
    finally:
        link.close()
        child.join(_PATIENCE)
        if child.is_alive():
            child.terminate()


@contextmanager
def page_process(host: str, port: int, folder: Path, announce: Callable[[str, bool], None]) -> Generator[Link]:
    """A page in a child process, for a loop that runs in this one.

    Args:
        host, port: where browsers connect.
        folder: where logs go.
        announce: told the address, and whether other machines can reach it.

    Raises:
        ConfigError: the address cannot be listened at.
        RunFailedError: the process of the page ended before the page could be opened.
    """
    context = multiprocessing.get_context("spawn")
    near, far = context.Pipe()
    child = context.Process(target=_run_page, args=(far, host, port, folder), name="pliant-page", daemon=True)
    child.start()
    far.close()
    try:
        url, exposed = near.recv()
    except EOFError as error:
        raise RunFailedError("the process of the page has ended before the page could be opened") from error
    if not url:
        raise ConfigError(exposed)
    announce(url, exposed)
    link = Link(near)
    try:
        yield link
    finally:
        link.close()
        child.join(_PATIENCE)
        if child.is_alive():
            child.terminate()


def _run_page(connection: Connection, host: str, port: int, folder: Path) -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C reaches the loop, which closes the link
    try:
        server = PageServer(host, port)
    except PliantError as error:
        connection.send(("", str(error)))
        return
    connection.send((server.url, server.exposed))
    with server:
        Page(server, Link(connection), folder).serve()


def _serve_until_told(page: Page) -> None:
    """Serves until Ctrl-C, or until the process is asked to end."""

    def end(number: int, frame: FrameType | None) -> None:
        page.stop()

    before = signal.signal(signal.SIGTERM, end)
    try:
        page.serve()
    finally:
        signal.signal(signal.SIGTERM, before)
