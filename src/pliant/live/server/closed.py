"""viser's web server with a door: its one socket is ours, and each request is asked for the token first."""

from __future__ import annotations

import contextlib
import io
import logging
import socket
import threading
from collections.abc import Callable
from typing import Any, cast

import viser
import websockets.asyncio.server as websocket_server
from websockets.asyncio.server import ServerConnection
from websockets.datastructures import Headers
from websockets.http11 import Request, Response

from pliant.live.server.access import Answer, Door

_ONE_AT_A_TIME = threading.Lock()
_PATIENCE = 10.0  # s for a request to arrive
_Process = Callable[[ServerConnection, Request], Response | None]


def closed_viser(door: Door, listening: socket.socket) -> viser.ViserServer:
    """A server of viser that listens at a given socket alone, behind a door.

    viser takes neither a socket nor a hook for requests, but hands both on to `websockets.asyncio.server.serve`; while
    the server is made, that name stands for a function that puts them in.
    """
    real = websocket_server.serve
    used = threading.Event()

    def serve(handler: Any, host: str, port: int, *, process_request: _Process, **settings: Any) -> Any:
        used.set()
        return real(
            handler,
            sock=listening,
            process_request=_asked(door, process_request),
            open_timeout=_PATIENCE,
            logger=_quiet(),
            **settings,
        )

    with _ONE_AT_A_TIME, silent():
        cast("Any", websocket_server).serve = serve
        try:
            server = viser.ViserServer("127.0.0.1", door.port, label="pliant", verbose=False)
        finally:
            cast("Any", websocket_server).serve = real
    if not used.is_set():
        server.stop()
        raise RuntimeError("this version of viser starts its server in another way; its page would be open to all")
    return server


def silent() -> contextlib.AbstractContextManager[Any]:
    """viser announces an address of its own, which is not the one to open."""
    return contextlib.redirect_stdout(io.StringIO())


def _asked(door: Door, further: _Process) -> _Process:
    def process(connection: ServerConnection, request: Request) -> Response | None:
        of = request.headers.get_all
        answer = door.answer(request.path, of("Host"), of("Origin"), of("Cookie"))
        return further(connection, request) if answer is None else _response(answer)

    return process


def _response(answer: Answer) -> Response:
    body = answer.text.encode()
    headers = Headers(answer.headers)
    headers["Content-Type"], headers["Content-Length"] = "text/plain; charset=utf-8", str(len(body))
    headers["Connection"] = "close"
    return Response(answer.status.value, answer.status.phrase, headers, body)


def _quiet() -> logging.Logger:
    """What strangers send is no news for the terminal."""
    logger = logging.getLogger("pliant.live.server")
    logger.setLevel(logging.CRITICAL + 1)
    return logger
