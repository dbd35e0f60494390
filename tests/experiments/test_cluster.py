"""Servers that are something else than a dask scheduler."""

from __future__ import annotations

import random
import socket
import struct
import threading
import time
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any, cast

import pytest

from benchmarks.endings import server
from pliant.errors import ConfigError, RunFailedError
from pliant.experiments import cluster
from pliant.experiments.open_pool import open_pool

GREETINGS = {
    "silent": b"",
    "one byte": b"x",
    "ssh": b"SSH-2.0-OpenSSH_9.2\r\n",
    "zeros": bytes(4096),
    "a huge length": b"\xff" * 64,
    "mysql": b"J\0\0\0\n8.0.33\0abc",
    "http": b"HTTP/1.1 400 Bad Request\r\n\r\n",
    "a length that fits": (64).to_bytes(8, "little") + bytes(64),
    **{f"random {seed}": random.Random(seed).randbytes(5000) for seed in range(5)},
}


@pytest.mark.parametrize("kind", GREETINGS)
def test_a_server_that_is_not_dask_is_one_sentence(kind: str) -> None:
    with (
        server(GREETINGS[kind]) as address,
        pytest.raises(ConfigError, match="no dask scheduler answers at") as caught,
        open_pool(1, address),
    ):
        pass
    assert len(str(caught.value).splitlines()) == 1


def test_a_port_where_nobody_listens_is_one_sentence() -> None:
    with socket.create_server(("127.0.0.1", 0)) as door:
        address = f"tcp://127.0.0.1:{door.getsockname()[1]}"
    with pytest.raises(ConfigError, match="no dask scheduler answers at"), open_pool(1, address):
        pass


@pytest.mark.parametrize("address", ["", "127.0.0.1:8786", "tls://a:1", "tcp://a", "tcp://a:99999999999", "tcp://a:²"])
def test_an_address_is_written_in_one_way(address: str) -> None:
    with pytest.raises(ConfigError, match="tcp://HOST:PORT"), open_pool(1, address):
        pass


class _LostAnswer:
    """A future whose worker died with the answer, and that no worker takes up again."""

    status, key = "finished", "lost"

    def add_done_callback(self, call: Callable[[object], None]) -> None:
        call(self)

    def exception(self, timeout: float) -> None:
        raise TimeoutError


class _Client:
    """A client of a scheduler without workers."""

    status, scheduler = "running", SimpleNamespace(identity=None)

    def submit(self, *_: object, **__: object) -> _LostAnswer:
        return _LostAnswer()

    def sync(self, *_: object, **__: object) -> dict[str, object]:
        return {"workers": {}}


def test_an_answer_that_was_lost_with_its_worker_is_not_waited_for(monkeypatch: pytest.MonkeyPatch) -> None:
    for name, seconds in (("_ALIVE", 0.0), ("_GONE", 0.1)):
        monkeypatch.setattr(cluster, name, seconds)
    pool = cluster._DaskPool(cast("Any", _Client()), "tcp://a:1", threading.Event())
    with pytest.raises(RunFailedError, match="all workers of the dask scheduler tcp://a:1 went away"):
        list(pool(abs, [1]))
    stop = threading.Event()
    stop.set()
    with pytest.raises(KeyboardInterrupt):
        list(cluster._DaskPool(cast("Any", _Client()), "tcp://a:1", stop)(abs, [1]))


def test_a_scheduler_that_takes_its_time_to_speak_is_waited_for() -> None:
    greeting = b"pickle-protocol".ljust(min(cluster._GREETING), b" ")
    with socket.socket() as listening:
        listening.bind(("127.0.0.1", 0))
        listening.listen()

        def speak() -> None:
            line, _ = listening.accept()
            with line:
                for part in (struct.pack("<Q", len(greeting)), greeting):
                    time.sleep(0.3)
                    line.sendall(part)

        speaker = threading.Thread(target=speak, daemon=True)
        speaker.start()
        cluster._knock("127.0.0.1", listening.getsockname()[1])
        speaker.join(10.0)
