"""viser's web server behind a check of the token: it listens on a socket of ours, and each request is checked first."""

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

from pliant.live.server.access import AccessControl, Answer

_ONE_AT_A_TIME = threading.Lock()
_PATIENCE = 10.0  # s for a request to arrive
_Process = Callable[[ServerConnection, Request], Response | None]


def protected_viser(access: AccessControl, listening: socket.socket) -> viser.ViserServer:
    """A viser server that listens on a given socket only, behind a check of each request.

    viser takes neither a socket nor a hook for requests, but hands both on to `websockets.asyncio.server.serve`; while
    the server is created, that name is replaced by a function that passes them on.
    """
    real = websocket_server.serve
    used = threading.Event()

    def serve(handler: Any, host: str, port: int, *, process_request: _Process, **settings: Any) -> Any:
        used.set()
        return real(
            handler,
            sock=listening,
            process_request=_asked(access, process_request),
            open_timeout=_PATIENCE,
            logger=_quiet(),
            **settings,
        )

    with _ONE_AT_A_TIME, silent():
        cast("Any", websocket_server).serve = serve
        try:
            server = viser.ViserServer("127.0.0.1", access.port, label="pliant", verbose=False)
        finally:
            cast("Any", websocket_server).serve = real
    if not used.is_set():
        server.stop()
        raise RuntimeError(
            "this version of viser starts its server differently, and its page would be open to everybody"
        )
    return server


def silent() -> contextlib.AbstractContextManager[Any]:
    """Silences viser, which would print an address that is not the one to open."""
    return contextlib.redirect_stdout(io.StringIO())


def _asked(access: AccessControl, further: _Process) -> _Process:
    def process(connection: ServerConnection, request: Request) -> Response | None:
        of = request.headers.get_all
        answer = access.answer(request.path, of("Host"), of("Origin"), of("Cookie"))
        return further(connection, request) if answer is None else _response(answer)

    return process


def _response(answer: Answer) -> Response:
    body = answer.text.encode()
    headers = Headers(answer.headers)
    headers["Content-Type"], headers["Content-Length"] = "text/plain; charset=utf-8", str(len(body))
    headers["Connection"] = "close"
    return Response(answer.status.value, answer.status.phrase, headers, body)


def _quiet() -> logging.Logger:
    """A logger that prints nothing, so that bad requests do not fill the terminal."""
    logger = logging.getLogger("pliant.live.server")
    logger.setLevel(logging.CRITICAL + 1)
    return logger
