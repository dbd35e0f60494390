"""Access to the page: only with the token of its link. Checked at the page's only port, before anything else.

The same check precedes every file and every websocket; without the token no request is served.
"""

from __future__ import annotations

import contextlib
import errno
import hmac
import ipaddress
import secrets
import socket
from collections.abc import Mapping
from dataclasses import dataclass
from http import HTTPStatus
from http.cookies import CookieError, SimpleCookie
from urllib.parse import parse_qs, urlsplit

from pliant.errors import ConfigError


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
class Answer:
    """The response in place of the page."""

    status: HTTPStatus
    text: str
    headers: Mapping[str, str]


@dataclass(frozen=True, slots=True)
class AccessControl:
    """Decides about each request from its target and headers.

    Args:
        host, port: where the page listens.
        token: what browsers must know; first in the link, then as a cookie.
    """

    host: str
    port: int
    token: str

    @property
    def cookie(self) -> str:
        """Name of the cookie; pages at several ports of one machine keep their own."""
        return f"pliant-token-{self.port}"

    def answer(self, target: str, hosts: list[str], origins: list[str], cookies: list[str]) -> Answer | None:
        """The response to a request that is refused; None if it is allowed.

        Args:
            target: path and query.
            hosts, origins, cookies: values of the headers Host, Origin and Cookie.
        """
        if len(hosts) != 1 or not self._knows(hosts[0]):
            return _refusal("open the page at the address that pliant printed")
        if any(origin != f"http://{hosts[0]}" for origin in origins):
            return _refusal("this page answers its own scripts only")
        if any(self._is_token(value) for value in _cookies(cookies, self.cookie)):
            return None
        try:
            url = urlsplit(target)
            given = parse_qs(url.query).get("token", [])
        except ValueError:
            return _refusal("open the page by the whole link that pliant printed, its token included")
        if url.path == "/" and len(given) == 1 and self._is_token(given[0]):
            cookie = f"{self.cookie}={self.token}; HttpOnly; SameSite=Strict; Path=/"
            return Answer(HTTPStatus.SEE_OTHER, "", {"Set-Cookie": cookie, "Location": "/"})
        return _refusal("open the page by the whole link that pliant printed, its token included")

    def _is_token(self, given: str) -> bool:
        return hmac.compare_digest(given.encode("utf-8", "replace"), self.token.encode())

    def _knows(self, host: str) -> bool:
        """Whether a Host header names this machine; a foreign one is an attempt to bypass the check of the origin."""
        try:
            name = urlsplit(f"//{host}").hostname or ""
        except ValueError:
            return False
        if is_loopback(name) or name == self.host.lower():
            return True
        return not is_loopback(self.host) and _is_address(name)


def _is_address(name: str) -> bool:
    with contextlib.suppress(ValueError):
        ipaddress.ip_address(name)
        return True
    return False


def _cookies(headers: list[str], name: str) -> list[str]:
    found: list[str] = []
    for header in headers:
        jar: SimpleCookie = SimpleCookie()
        with contextlib.suppress(CookieError):
            jar.load(header)
        if name in jar:
            found.append(jar[name].value)
    return found


def _refusal(text: str) -> Answer:
    return Answer(HTTPStatus.FORBIDDEN, text, {})


def listen(host: str, port: int) -> socket.socket:
    """A socket that listens at an address; port 0 takes any free one.

    Raises:
        ConfigError: the address cannot be listened at.
    """
    try:
        family, kind, protocol, _, address = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0]
    except (socket.gaierror, OverflowError, UnicodeError) as error:
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
