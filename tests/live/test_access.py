"""Who gets in: this machine without a token, others with it, other pages' scripts never."""

from __future__ import annotations

import http.client
import socket
from collections.abc import Iterator

import pytest

from pliant.errors import ConfigError
from pliant.live.server.access import Gate, Head, is_loopback
from pliant.live.server.web import PageServer

TOKEN = "a-secret"


@pytest.fixture(scope="module")
def inner() -> Iterator[PageServer]:
    with PageServer("127.0.0.1", 0) as server:
        yield server


@pytest.fixture
def guarded(inner: PageServer) -> Iterator[Gate]:
    gate = Gate("127.0.0.1", 0, inner.viser.get_port(), TOKEN)
    yield gate
    gate.stop()


def ask(port: int, target: str = "/", **headers: str) -> http.client.HTTPResponse:
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=20)
    try:
        connection.request("GET", target, headers=headers)
        answer = connection.getresponse()
        answer.read()
        return answer
    finally:
        connection.close()


def test_this_machine_needs_no_token(inner: PageServer) -> None:
    assert not inner.guarded
    assert ask(inner.port).status == 200


def test_without_the_token_nobody_gets_in(guarded: Gate) -> None:
    assert ask(guarded.port).status == 403
    assert ask(guarded.port, "/?token=wrong").status == 403
    assert ask(guarded.port, Cookie="pliant-token=wrong").status == 403
    assert ask(guarded.port, Upgrade="websocket", Connection="Upgrade").status == 403


def test_the_token_becomes_a_cookie_that_opens_the_page(guarded: Gate) -> None:
    answer = ask(guarded.port, f"/?token={TOKEN}")
    assert answer.status == 303
    cookie = answer.getheader("Set-Cookie") or ""
    assert "HttpOnly" in cookie
    assert ask(guarded.port, Cookie=cookie.split(";")[0]).status == 200


def test_scripts_of_other_pages_are_kept_out(inner: PageServer) -> None:
    """A page elsewhere may make the browser open a websocket to this machine; its origin gives it away."""
    own = {
        "Upgrade": "websocket",
        "Connection": "Upgrade",
        "Sec-WebSocket-Version": "13",
        "Sec-WebSocket-Key": "x" * 22,
    }
    assert ask(inner.port, Origin="http://evil.example", **own).status == 403
    assert ask(inner.port, Host="evil.example").status == 403
    assert ask(inner.port, Origin=f"http://127.0.0.1:{inner.port}").status == 200


def test_nonsense_gets_a_clear_answer(inner: PageServer) -> None:
    with socket.create_connection(("127.0.0.1", inner.port), timeout=20) as raw:
        raw.sendall(b"hello\r\n\r\n")
        assert raw.recv(100).startswith(b"HTTP/1.1 400")


def test_a_port_in_use_is_named(inner: PageServer) -> None:
    with pytest.raises(ConfigError, match=f"port {inner.port} on 127.0.0.1 is in use; choose another one with --port"):
        PageServer("127.0.0.1", inner.port)


def test_a_host_that_is_not_here(inner: PageServer) -> None:
    with pytest.raises(ConfigError, match=r"--host must be an address of this machine|cannot listen"):
        Gate("no-such-host.invalid", 0, inner.viser.get_port())


@pytest.mark.parametrize(
    ("host", "loopback"),
    [("127.0.0.1", True), ("::1", True), ("localhost", True), ("0.0.0.0", False), ("10.0.0.7", False)],
)
def test_loopback(host: str, loopback: bool) -> None:
    assert is_loopback(host) is loopback


def test_heads_are_read_or_refused() -> None:
    head = Head.parse(b"GET /?token=t HTTP/1.1\r\nHost: a:1\r\nCookie: x=1; pliant-token=c\r\n\r\n")
    assert head is not None
    assert (head.token, head.cookie, head.headers["host"]) == ("t", "c", "a:1")
    assert Head.parse(b"POST / HTTP/1.1\r\n\r\n") is None
