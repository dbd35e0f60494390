"""Where the tasks of a sweep are done: in this process, in processes of its own, or on a running dask scheduler."""

from __future__ import annotations

import logging
import os
import signal
import socket
import threading
from collections.abc import Callable, Generator, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from multiprocessing import resource_tracker
from queue import Empty, SimpleQueue
from types import FrameType
from typing import TYPE_CHECKING, Any, Protocol, TypeVar

from pliant import __version__
from pliant.errors import ConfigError, RunFailedError

if TYPE_CHECKING:
    from distributed import Client, Future

T = TypeVar("T")
R = TypeVar("R")
_KNOCK, _ANSWER = 2.0, 3.0  # s for a scheduler's port to open, and for what is behind it to answer as dask does
_WORKERS = 15.0  # s for the first worker to report: they may have been started together with the scheduler
_LOOK = 0.2  # s between two looks for Ctrl-C


@dataclass(frozen=True)
class Lost:
    """A task that was started several times and whose process died each time."""

    reason: str


class Pool(Protocol):
    """Does tasks."""

    def __call__(self, function: Callable[[T], R], tasks: Sequence[T]) -> Iterator[tuple[int, R | Lost]]:
        """Yields the index of each task with what the function returned, in the order in which they end."""
        ...


def in_this_process(function: Callable[[T], R], tasks: Sequence[T]) -> Iterator[tuple[int, R | Lost]]:
    """One after the other, without any other process."""
    for index, task in enumerate(tasks):
        yield index, function(task)


@contextmanager
def open_pool(jobs: int = 1, scheduler: str | None = None) -> Generator[Pool]:
    """A pool for the tasks of one command.

    Args:
        jobs: processes on this machine; one means this very process. Results do not depend on it.
        scheduler: address of a running dask scheduler, `tcp://HOST:PORT`, whose workers are used instead.

    Raises:
        ConfigError: fewer than one job, or a scheduler that does not answer or whose workers have another pliant.
    """
    if jobs < 1:
        raise ConfigError(f"a sweep needs at least one job, got {jobs}")
    if scheduler is None and jobs == 1:
        yield in_this_process
        return
    _quiet()
    with _interrupt_later() as interrupted:
        if scheduler is not None:
            with _connected(scheduler) as client:
                yield _DaskPool(client, interrupted)
        else:
            with _local(jobs) as client:
                yield _DaskPool(client, interrupted)


class _DaskPool:
    def __init__(self, client: Client, interrupted: threading.Event) -> None:
        self._client, self._interrupted = client, interrupted

    def __call__(self, function: Callable[[T], R], tasks: Sequence[T]) -> Iterator[tuple[int, R | Lost]]:
        ended: SimpleQueue[Future[Any]] = SimpleQueue()
        waiting: dict[object, tuple[int, Future[Any]]] = {}  # a future that nobody holds is forgotten by the scheduler
        for index, task in enumerate(tasks):
            future = self._client.submit(function, task, pure=False)
            waiting[future.key] = index, future
            future.add_done_callback(ended.put)
        try:
            while waiting:
                future = self._next(ended)
                index, _ = waiting.pop(future.key)
                yield index, _outcome(future)
        finally:
            if waiting and self._client.status == "running":
                self._client.cancel([future for _, future in waiting.values()], force=True)

    def _next(self, ended: SimpleQueue[Future[Any]]) -> Future[Any]:
        """The next task that ended. Ctrl-C counts once everything that ended was handed out."""
        while True:
            try:
                return ended.get(timeout=0.001 if self._interrupted.is_set() else _LOOK)
            except Empty:
                if self._interrupted.is_set():
                    raise KeyboardInterrupt from None


def _outcome(future: Future[Any]) -> Any:
    """What a task returned. A task whose worker dies is started again by the scheduler, three times."""
    from distributed import KilledWorker

    if future.status == "cancelled":
        raise RunFailedError("the dask scheduler went away; what had ended until then is kept")
    error = future.exception()
    if error is None:
        return future.result()
    if isinstance(error, KilledWorker):
        return Lost(f"its process died, {error.allowed_failures + 1} times in a row")
    return Lost(f"the worker could not run it: {type(error).__name__}: {error}")


@contextmanager
def _local(jobs: int) -> Generator[Client]:
    import dask.config
    from distributed import Client, LocalCluster

    os.environ.setdefault("OMP_NUM_THREADS", "1")  # inherited by the workers: one thread each
    # a worker that dies casts suspicion on all tasks it holds: it holds none but the one it runs
    with _shielded(), dask.config.set({"distributed.scheduler.worker-saturation": 1.0}):
        cluster = LocalCluster(
            n_workers=jobs, threads_per_worker=1, dashboard_address=":0", silence_logs=logging.CRITICAL
        )
    with cluster, Client(cluster) as client:
        yield client
        with suppress(TimeoutError):  # a worker that is closed while it takes a dead one's place complains aloud
            client.wait_for_workers(jobs, timeout=_WORKERS)


@contextmanager
def _connected(scheduler: str) -> Generator[Client]:
    from distributed import Client

    try:
        _knock(*_address(scheduler))
        client = Client(scheduler, timeout=_ANSWER, set_as_default=False)
    except OSError as error:
        why = str(error) or type(error).__name__
        raise ConfigError(f"no dask scheduler answers at {scheduler} ({why}); `dask scheduler` starts one") from None
    with client:
        try:
            client.wait_for_workers(1, timeout=_WORKERS)
        except TimeoutError:
            raise ConfigError(
                f"the dask scheduler {scheduler} has no workers; `dask worker {scheduler}` starts some"
            ) from None
        _check_versions(client, scheduler)
        yield client


def _address(scheduler: str) -> tuple[str, int]:
    scheme, _, rest = scheduler.partition("://")
    host, _, port = rest.rpartition(":")
    if scheme != "tcp" or not host or not port.isdecimal():
        raise ConfigError(f"a scheduler's address is written tcp://HOST:PORT, got {scheduler!r}")
    return host.strip("[]"), int(port)


def _knock(host: str, port: int) -> None:
    """Raises OSError if nothing is there, or if it does not speak first, as dask does: its client would wait long."""
    with socket.create_connection((host, port), timeout=_KNOCK) as line:
        line.settimeout(_KNOCK)
        if not line.recv(1):
            raise ConnectionError("what listens there is something else")


def _check_versions(client: Client, scheduler: str) -> None:
    try:
        found: dict[str, str] = client.run(_version)  # pyright: ignore[reportAssignmentType] (not a coroutine here)
    except Exception as error:  # whatever a foreign worker makes of it
        raise ConfigError(
            f"the workers of {scheduler} cannot import pliant {__version__}: {type(error).__name__}: {error}"
        ) from None
    for worker, version in found.items():
        if version != __version__:
            raise ConfigError(f"worker {worker} of {scheduler} has pliant {version}, this is pliant {__version__}")


def _version() -> str:
    return __version__


def _quiet() -> None:
    """Dask's log goes to standard error, amid the progress bar: what matters of it is in our own sentences."""
    names = ("distributed", "distributed.client", "distributed.core", "distributed.comm", "tornado.application")
    for name in names:
        logging.getLogger(name).setLevel(logging.CRITICAL)
    os.environ.setdefault("DASK_LOGGING__DISTRIBUTED", "critical")  # workers read it when they start


@contextmanager
def _shielded() -> Generator[None]:
    """Threads and processes started in here, and theirs, never see Ctrl-C, which a terminal sends to all of them."""
    resource_tracker.ensure_running()  # it would unblock the signal where it is started
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextmanager
def _interrupt_later() -> Generator[threading.Event]:
    """The first Ctrl-C sets the event, so that nothing is cut off in the middle; the second one interrupts."""
    asked = threading.Event()

    def note(_number: int, _frame: FrameType | None) -> None:
        if asked.is_set():
            raise KeyboardInterrupt
        asked.set()

    if threading.current_thread() is not threading.main_thread():
        yield asked  # signals come to the main thread only
        return
    before = signal.signal(signal.SIGINT, note)
    try:
        yield asked
    finally:
        signal.signal(signal.SIGINT, before)
