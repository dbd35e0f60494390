"""Who gets in: whoever has the token, on this machine too; other pages' scripts never; nothing else listens."""

from __future__ import annotations

import http.client
import os
import socket
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import ClientConnection, connect
from websockets.typing import Origin, Subprotocol

from pliant.errors import ConfigError
from pliant.live.server import protected
from pliant.live.server.access import AccessControl, is_loopback, listen
from pliant.live.server.web import PageServer

WEBSOCKET = {
    "Upgrade": "websocket",
    "Connection": "Upgrade",
    "Sec-WebSocket-Version": "13",
    "Sec-WebSocket-Key": "dGhlIHNhbXBsZSBub25jZQ==",
}


@pytest.fixture(scope="module")
def server() -> Iterator[PageServer]:
    with PageServer("127.0.0.1", 0) as made:
        yield made


def token(server: PageServer) -> str:
    return server.url.partition("?token=")[2]


def cookie(server: PageServer) -> str:
    return f"pliant-token-{server.port}={token(server)}"


def ask(port: int, target: str = "/", **headers: str) -> http.client.HTTPResponse:
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=20)
    try:
        connection.request("GET", target, headers={name.replace("_", "-"): text for name, text in headers.items()})
        answer = connection.getresponse()
        if answer.status != 101:
            answer.read()
        return answer
    finally:
        connection.close()


def opened(server: PageServer) -> ClientConnection:
    import viser

    return connect(
        f"ws://127.0.0.1:{server.port}/",
        additional_headers={"Cookie": cookie(server)},
        origin=Origin(f"http://127.0.0.1:{server.port}"),
        subprotocols=[Subprotocol(f"viser-v{viser.__version__}")],
        max_size=None,
    )


def send_and_read(page: ClientConnection, frame: str | bytes) -> None:
    """Sends a frame and reads until the server hangs up."""
    page.send(frame)
    while True:
        page.recv(timeout=20)


def listening_ports() -> set[int]:
    """TCP ports at which this process listens."""
    mine = {os.readlink(path) for path in Path("/proc/self/fd").iterdir() if path.is_symlink()}
    ports: set[int] = set()
    for table in (Path("/proc/net/tcp"), Path("/proc/net/tcp6")):
        for line in table.read_text().splitlines()[1:] if table.exists() else ():
            words = line.split()
            if words[3] == "0A" and f"socket:[{words[9]}]" in mine:
                ports.add(int(words[1].rpartition(":")[2], 16))
    return ports


@pytest.mark.skipif(not Path("/proc/net/tcp").exists(), reason="needs Linux")
def test_no_port_of_the_process_answers_without_the_token() -> None:
    before = listening_ports()
    with PageServer("127.0.0.1", 0) as server:
        ports = listening_ports() - before
        assert ports == {server.port}
        for port in ports:
            assert ask(port).status == 403
            assert ask(port, **WEBSOCKET).status == 403
    assert listening_ports() == before


@pytest.mark.parametrize("more", [{}, WEBSOCKET], ids=["http", "websocket"])
def test_without_the_token_nobody_gets_in(server: PageServer, more: dict[str, str]) -> None:
    secret = token(server)
    assert ask(server.port, **more).status == 403
    assert ask(server.port, "/?token=wrong", **more).status == 403
    assert ask(server.port, "/?token=", **more).status == 403
    assert ask(server.port, "/?token=%FF%00", **more).status == 403
    assert ask(server.port, "/index.html", **more).status == 403
    for target in (f"/{secret}", f"/?other={secret}", f"/index.html?token={secret}", f"/?token={secret}&token=x"):
        assert ask(server.port, target, **more).status == 403, target
    for name in ("Authorization", "X_Token", "Referer", "Sec_WebSocket_Protocol"):
        assert ask(server.port, **more, **{name: secret}).status == 403, name
    for text in ("pliant-token=" + secret, cookie(server)[:-1], cookie(server) + "x", '=;;,"=', secret):
        assert ask(server.port, **more, Cookie=text).status == 403, text


def test_the_token_becomes_a_cookie_that_opens_the_page(server: PageServer) -> None:
    answer = ask(server.port, f"/?token={token(server)}")
    assert answer.status == 303
    given = answer.getheader("Set-Cookie") or ""
    assert "HttpOnly" in given
    assert "SameSite=Strict" in given
    assert ask(server.port, Cookie=given.split(";")[0]).status == 200
    with opened(server) as page:
        assert page.recv(timeout=20)


@pytest.mark.parametrize("more", [{}, WEBSOCKET], ids=["http", "websocket"])
def test_foreign_names_and_origins_are_kept_out_with_the_token_too(server: PageServer, more: dict[str, str]) -> None:
    port, own = server.port, {**more, "Cookie": cookie(server)}
    for origin in ("http://evil.example", "null", f"http://127.0.0.1:{port + 1}", f"https://127.0.0.1:{port}", ""):
        assert ask(port, **own, Origin=origin).status == 403, origin
    for host in ("evil.example", f"evil.example:{port}", "10.0.0.7", "127.0.0.1.evil.example", "[", "", "a@evil"):
        assert ask(port, **own, Host=host).status == 403, host
        assert ask(port, f"/?token={token(server)}", **more, Host=host).status == 403, host


def test_paths_lead_nowhere_else(server: PageServer) -> None:
    for up in ("..", "%2e%2e", "..%2f..", "%2e%2e%5c", "..\\.."):
        path = "/" + "/".join([up] * 12) + "/etc/passwd"
        assert ask(server.port, path, Cookie=cookie(server)).status == 404, path
        assert ask(server.port, path).status == 403, path
    assert ask(server.port, "//etc/passwd", Cookie=cookie(server)).status == 404


def test_garbage_in_place_of_a_request(server: PageServer) -> None:
    draw = np.random.default_rng(4)
    heads = [b"hello\r\n\r\n", b"POST / HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n", b"GET / HTTP/1.1\r\nHost 127\r\n\r\n"]
    heads += [b"GET /" + b"a" * 100_000 + b" HTTP/1.1\r\n\r\n", b"GET / HTTP/1.1\r\n" + b"a: b\r\n" * 5000 + b"\r\n"]
    heads += [draw.bytes(int(size)) + b"\r\n\r\n" for size in draw.integers(1, 5000, 40)]
    for head in heads:
        with socket.create_connection(("127.0.0.1", server.port), timeout=20) as raw:
            said = b""
            try:
                raw.sendall(head)
                raw.shutdown(socket.SHUT_WR)
                said = raw.recv(100)
            except ConnectionError:
                pass  # hung up
            assert not said or said.startswith(b"HTTP/1.1 4"), (head[:40], said)
    assert ask(server.port, Cookie=cookie(server)).status == 200


def test_slow_strangers_hold_nobody_up(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(protected, "_PATIENCE", 1.0)
    with PageServer("127.0.0.1", 0) as server:
        _hold_up(server)


def _hold_up(server: PageServer) -> None:
    silent = [socket.create_connection(("127.0.0.1", server.port), timeout=30) for _ in range(20)]
    try:
        silent[0].sendall(b"G")
        assert ask(server.port, Cookie=cookie(server)).status == 200
        said = silent[0].recv(100)  # hung up on after a while
        assert not said or said.startswith(b"HTTP/1.1 4")
    finally:
        for one in silent:
            one.close()


def test_hostile_frames_end_their_own_connection_only(server: PageServer, capfd: pytest.CaptureFixture[str]) -> None:
    draw = np.random.default_rng(5)
    with opened(server) as other:
        other.recv(timeout=20)
        for frame in ("text", b"", draw.bytes(1000), b"\xc1", b"\x00" * (51 * 1024 * 1024)):
            with opened(server) as page, pytest.raises(ConnectionClosed):
                send_and_read(page, frame)
        other.ping().wait(20)
        assert ask(server.port, Cookie=cookie(server)).status == 200
    with pytest.raises(InvalidStatus):
        connect(f"ws://127.0.0.1:{server.port}/")
    assert "Traceback" not in capfd.readouterr().err


def test_a_port_in_use_is_named(server: PageServer) -> None:
    with pytest.raises(ConfigError, match=f"port {server.port} on 127.0.0.1 is in use; choose another one with --port"):
        PageServer("127.0.0.1", server.port)


def test_a_host_that_is_not_here() -> None:
    with pytest.raises(ConfigError, match=r"--host must be an address of this machine|cannot listen"):
        listen("no-such-host.invalid", 0)


def test_a_page_for_others_knows_addresses_but_no_foreign_names() -> None:
    access = AccessControl("0.0.0.0", 80, "secret")
    held = ["pliant-token-80=secret"]
    assert access.answer("/", ["10.0.0.7:80"], [], held) is None
    assert access.answer("/", ["evil.example"], [], held) is not None
    assert access.answer("/", ["10.0.0.7"], [], []) is not None
    assert access.answer("/", ["10.0.0.7", "evil.example"], [], held) is not None


@pytest.mark.parametrize(
    ("host", "loopback"),
    [("127.0.0.1", True), ("::1", True), ("localhost", True), ("0.0.0.0", False), ("10.0.0.7", False)],
)
def test_loopback(host: str, loopback: bool) -> None:
    assert is_loopback(host) is loopback
