"""Who may see the page: everybody on this machine, and from elsewhere whoever has the token.

A gate listens where the user asked for, looks at the head of each connection, and passes the bytes on to the page's own
server, which listens on the loopback interface alone.
"""

from __future__ import annotations

import asyncio
import contextlib
import errno
import hmac
import ipaddress
import secrets
import socket
import threading
from collections.abc import Mapping
from dataclasses import dataclass
from http.cookies import CookieError, SimpleCookie
from urllib.parse import parse_qs, urlsplit

from pliant.errors import ConfigError

_COOKIE = "pliant-token"
_HEAD_LIMIT = 32_768  # bytes
_PATIENCE = 10.0  # s for a head to arrive
_CHUNK = 65_536  # bytes


def is_loopback(host: str) -> bool:
    """Whether only programs on this machine can reach an address."""
    if host == "localhost":
        return True
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False


def new_token() -> str:
    """A secret that goes into a link."""
    return secrets.token_urlsafe(16)


@dataclass(frozen=True, slots=True)
class Head:
    """First lines of an HTTP request."""

    target: str
    headers: Mapping[str, str]
    """lower-case name → value"""

    @staticmethod
    def parse(raw: bytes) -> Head | None:
        """Reads a head; None if it is none."""
        first, *lines = raw.decode("latin-1").split("\r\n")
        words = first.split(" ")
        if len(words) != 3 or words[0] != "GET":
            return None
        pairs = (line.partition(":") for line in lines if ":" in line)
        return Head(words[1], {name.strip().lower(): value.strip() for name, _, value in pairs})

    @property
    def token(self) -> str:
        """The token in the address; empty if there is none."""
        return parse_qs(urlsplit(self.target).query).get("token", [""])[0]

    @property
    def cookie(self) -> str:
        """The token in the cookies; empty if there is none."""
        jar: SimpleCookie = SimpleCookie()
        with contextlib.suppress(CookieError):
            jar.load(self.headers.get("cookie", ""))
        return jar[_COOKIE].value if _COOKIE in jar else ""

    @property
    def is_foreign(self) -> bool:
        """Whether another page's script asks: its origin is not the host that it talks to."""
        origin = self.headers.get("origin")
        return origin is not None and urlsplit(origin).netloc != self.headers.get("host", "")


class Gate:
    """Listens at an address and passes connections on.

    Args:
        host, port: where browsers connect; port 0 takes any free one.
        inner: port of the page's server on the loopback interface.
        token: what browsers must know; empty: nothing.

    Raises:
        ConfigError: the address cannot be listened at.
    """

    def __init__(self, host: str, port: int, inner: int, token: str = "") -> None:
        self._inner, self._token, self._host = inner, token, host
        self._socket = _listen(host, port)
        self.port = int(self._socket.getsockname()[1])
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._run, name="pliant-live-gate", daemon=True)
        self._thread.start()

    def stop(self) -> None:
        """Closes the address and every connection."""
        with contextlib.suppress(RuntimeError):
            self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join(2.0)

    def _run(self) -> None:
        asyncio.set_event_loop(self._loop)
        server = self._loop.run_until_complete(asyncio.start_server(self._serve, sock=self._socket))
        try:
            self._loop.run_forever()
        finally:
            server.close()
            tasks = asyncio.all_tasks(self._loop)
            for task in tasks:
                task.cancel()
            self._loop.run_until_complete(asyncio.gather(*tasks, return_exceptions=True))
            self._loop.close()

    async def _serve(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        try:
            raw = await asyncio.wait_for(reader.readuntil(b"\r\n\r\n"), _PATIENCE)
            head = Head.parse(raw) if len(raw) <= _HEAD_LIMIT else None
            answer = self._answer(head)
            if answer:
                writer.write(answer)
                await writer.drain()
                return
            await self._pass_on(raw, reader, writer)
        except (TimeoutError, asyncio.CancelledError, asyncio.IncompleteReadError, asyncio.LimitOverrunError, OSError):
            pass
        finally:
            writer.close()

    def _answer(self, head: Head | None) -> bytes:
        """What the gate itself says; nothing if the connection may pass."""
        if head is None:
            return _response("400 Bad Request", "not a request that this page understands")
        if head.is_foreign:
            return _response("403 Forbidden", "this page answers its own scripts only")
        if not self._token:
            return (
                b""
                if self._knows(head)
                else _response("403 Forbidden", "open the page by the address that pliant printed")
            )
        if hmac.compare_digest(head.cookie.encode(), self._token.encode()):
            return b""
        if hmac.compare_digest(head.token.encode(), self._token.encode()):
            cookie = f"Set-Cookie: {_COOKIE}={self._token}; HttpOnly; SameSite=Strict; Path=/\r\nLocation: /\r\n"
            return _response("303 See Other", "", cookie)
        return _response("403 Forbidden", "open the page by the whole link that pliant printed, its token included")

    def _knows(self, head: Head) -> bool:
        """Whether a request that needs no token names this machine: another name is a trick to get past the origin."""
        name = urlsplit(f"//{head.headers.get('host', '')}").hostname or ""
        return is_loopback(name)

    async def _pass_on(self, raw: bytes, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        far_reader, far_writer = await asyncio.open_connection("127.0.0.1", self._inner)
        far_writer.write(raw)
        ways = [asyncio.ensure_future(_pump(reader, far_writer)), asyncio.ensure_future(_pump(far_reader, writer))]
        try:
            await asyncio.wait(ways, return_when=asyncio.FIRST_COMPLETED)
        finally:
            for way in ways:
                way.cancel()
            far_writer.close()


async def _pump(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
    with contextlib.suppress(OSError):
        while data := await reader.read(_CHUNK):
            writer.write(data)
            await writer.drain()


def _response(status: str, text: str, headers: str = "") -> bytes:
    body = text.encode()
    head = f"HTTP/1.1 {status}\r\nContent-Type: text/plain; charset=utf-8\r\nContent-Length: {len(body)}\r\n"
    return f"{head}{headers}Connection: close\r\n\r\n".encode() + body


def _listen(host: str, port: int) -> socket.socket:
    try:
        family, kind, protocol, _, address = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0]
    except (socket.gaierror, OverflowError) as error:
        raise ConfigError(f"--host must be an address of this machine, got {host!r} ({error})") from error
    made = socket.socket(family, kind, protocol)
    made.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        made.bind(address)
        made.listen(64)
    except OSError as error:
        made.close()
        if error.errno == errno.EADDRINUSE:
            raise ConfigError(
                f"port {port} on {host} is in use; choose another one with --port, or --port 0 for any"
            ) from error
        raise ConfigError(f"cannot listen at {host} port {port}: {error.strerror}") from error
    return made
