"""Runs tasks on the workers of a running dask scheduler. Connection errors become one sentence."""

from __future__ import annotations

import logging
import os
import socket
import struct
import threading
import time
from collections.abc import Callable, Generator, Iterator, Sequence
from contextlib import contextmanager, suppress
from queue import Empty, SimpleQueue
from typing import TYPE_CHECKING, Any, TypeVar

from pliant import __version__
from pliant.errors import ConfigError, MissingExtraError, RunFailedError
from pliant.experiments.pool import Lost, Pool

if TYPE_CHECKING:
    from distributed import Client, Future

T = TypeVar("T")
R = TypeVar("R")
_KNOCK, _ANSWER = 2.0, 3.0  # s, time limit for the first bytes of a scheduler's port, and for the scheduler's answer
_WORKERS = 6.0  # s, time limit for the first worker, which may have been started together with the scheduler
_VERSION = 3.0  # s, time limit for all workers to import pliant and report its version
_LOOK = 0.2  # s between two checks for Ctrl-C
_ALIVE, _GONE = 2.0, 8.0  # s between two checks of scheduler and workers, and until they count as lost
_GREETING = range(16, 1 << 16)  # bytes of dask's first message


@contextmanager
def connected(scheduler: str, interrupted: threading.Event) -> Generator[Pool]:
    """A pool of a scheduler's workers.

    Args:
        scheduler: its address, `tcp://HOST:PORT`.
        interrupted: set when the user asked to stop: finished tasks are returned, then KeyboardInterrupt is raised.

    Raises:
        ConfigError: the server is not a dask scheduler, has no workers, or another version of pliant.
        MissingExtraError: dask is not installed.
    """
    host, port = _address(scheduler)
    try:
        from distributed import Client
    except ImportError:
        raise MissingExtraError(
            "--scheduler needs dask's `distributed`, which is not installed: pip install 'pliant[cluster]'"
        ) from None
    _quiet()
    try:
        _knock(host, port)
        client = Client(scheduler, timeout=_ANSWER, set_as_default=False)
    except Exception as error:  # any error of dask with a server of another kind
        why = str(error).partition("\n")[0] or type(error).__name__
        raise ConfigError(f"no dask scheduler answers at {scheduler} ({why}); `dask scheduler` starts one") from None
    try:
        try:
            client.wait_for_workers(1, timeout=_WORKERS)
        except TimeoutError:
            raise ConfigError(
                f"the dask scheduler {scheduler} has no workers; `dask worker {scheduler}` starts some"
            ) from None
        _check_versions(client, scheduler)
        yield _DaskPool(client, scheduler, interrupted)
    finally:
        with suppress(TimeoutError):  # the scheduler may be gone already
            client.close(timeout=_KNOCK)


class _DaskPool:
    def __init__(self, client: Client, scheduler: str, interrupted: threading.Event) -> None:
        self._client, self._scheduler, self._interrupted = client, scheduler, interrupted
        self._seen = self._looked = 0.0

    def __call__(self, function: Callable[[T], R], tasks: Sequence[T]) -> Iterator[tuple[int, R | Lost]]:
        ended: SimpleQueue[Future[Any]] = SimpleQueue()
        waiting: dict[object, tuple[int, Future[Any]]] = {}  # the scheduler forgets a future without a reference
        for index, task in enumerate(tasks):
            future = self._client.submit(function, task, pure=False)
            waiting[future.key] = index, future
            future.add_done_callback(ended.put)
        self._seen = time.monotonic()
        try:
            while waiting:
                future = self._next(ended)
                index, _ = waiting.pop(future.key)
                yield index, self._outcome(future)
        finally:
            if waiting and self._client.status == "running":
                with suppress(OSError, TimeoutError):  # the scheduler is gone
                    self._client.cancel([future for _, future in waiting.values()], force=True)

    def _next(self, ended: SimpleQueue[Future[Any]]) -> Future[Any]:
        """The next finished task. Ctrl-C takes effect after all finished tasks have been returned."""
        while True:
            try:
                return ended.get(timeout=0.001 if self._interrupted.is_set() else _LOOK)
            except Empty:
                if self._interrupted.is_set():
                    raise KeyboardInterrupt from None
            self._check_alive()

    def _outcome(self, future: Future[Any]) -> Any:
        """What a task returned. A task whose worker dies is started again by the scheduler, three times.

        The result stays with the worker until it is fetched; if the worker dies before, the task counts as not
        finished, and the scheduler waits for another worker without a time limit.
        """
        from distributed import KilledWorker

        while True:
            if future.status == "cancelled":
                raise self._gone("the dask scheduler", "went away")
            try:
                error = future.exception(timeout=_ALIVE)
                if error is None:
                    return future.result(timeout=_ALIVE)
                break
            except TimeoutError:
                if self._interrupted.is_set():
                    raise KeyboardInterrupt from None
                self._check_alive()
            except OSError:  # the connection broke while the answer was fetched
                raise self._gone("the dask scheduler", "went away") from None
        if isinstance(error, KilledWorker):
            return Lost(f"its process died, {error.allowed_failures + 1} times in a row")
        return Lost(f"the worker could not run it: {type(error).__name__}: {error}")

    def _check_alive(self) -> None:
        """Raises RunFailedError if the scheduler or all its workers have been lost for a while."""
        now = time.monotonic()
        if now < self._looked + _ALIVE:
            return
        workers = None
        if self._client.status == "running":
            try:
                client: Any = self._client  # its `scheduler` is untyped
                workers = len(client.sync(client.scheduler.identity, callback_timeout=_ALIVE)["workers"])
            except Exception:  # a broken connection raises various errors
                workers = None
        self._looked = time.monotonic()
        if workers:
            self._seen = self._looked
        elif self._looked > self._seen + _GONE:
            what = "the dask scheduler" if workers is None else "all workers of the dask scheduler"
            raise self._gone(what, "went away")

    def _gone(self, what: str, happened: str) -> RunFailedError:
        return RunFailedError(f"{what} {self._scheduler} {happened}; what had finished before is kept")


def _address(scheduler: str) -> tuple[str, int]:
    scheme, _, rest = scheduler.partition("://")
    host, _, port = rest.rpartition(":")
    if scheme != "tcp" or not host or not port.isascii() or not port.isdecimal() or not 0 < int(port[:6]) < 1 << 16:
        raise ConfigError(f"a scheduler's address is written tcp://HOST:PORT, got {scheduler!r}")
    return host.strip("[]"), int(port)


def _knock(host: str, port: int) -> None:
    """Raises OSError unless the server sends first, as dask does: dask's own client would wait long for another server,
    or accept any message length."""
    until = time.monotonic() + _KNOCK
    with socket.create_connection((host, port), timeout=_KNOCK) as line:
        (length,) = struct.unpack("<Q", _received(line, 8, until))
        if length not in _GREETING or b"pickle-protocol" not in _received(line, length, until):
            raise ConnectionError("what listens there is something else")


def _received(line: socket.socket, count: int, until: float) -> bytes:
    data = b""
    while len(data) < count:
        line.settimeout(max(until - time.monotonic(), 1e-3))
        part = line.recv(count - len(data))
        if not part:
            raise ConnectionError("what listens there is something else")
        data += part
    return data


def _check_versions(client: Client, scheduler: str) -> None:
    try:
        run: Any = client.run  # its time limit is untyped
        found: dict[str, str] = run(_version, callback_timeout=_VERSION)
    except TimeoutError:
        raise ConfigError(f"the workers of {scheduler} do not answer; start them again") from None
    except Exception as error:  # any error of a foreign worker
        raise ConfigError(
            f"the workers of {scheduler} cannot import pliant {__version__}: {type(error).__name__}: {error}"
        ) from None
    for worker, version in found.items():
        if version != __version__:
            raise ConfigError(f"worker {worker} of {scheduler} has pliant {version}, this is pliant {__version__}")


def _version() -> str:
    return __version__


def _quiet() -> None:
    """Silences dask's log, which would disturb the progress bar; pliant reports what matters."""
    names = ("distributed", "distributed.client", "distributed.core", "distributed.comm", "tornado.application")
    for name in names:
        logging.getLogger(name).setLevel(logging.CRITICAL)
    os.environ.setdefault("DASK_LOGGING__DISTRIBUTED", "critical")  # workers read it when they start
