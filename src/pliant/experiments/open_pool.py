"""Opens a pool for the tasks of a sweep: this process, child processes, or a running scheduler."""

from __future__ import annotations

import signal
import threading
from collections.abc import Generator
from contextlib import contextmanager
from types import FrameType

from pliant.errors import ConfigError
from pliant.experiments.pool import Pool, in_this_process

MOST_JOBS = 1024
"""largest number of processes of one command; more is taken for a typing error"""


@contextmanager
def open_pool(jobs: int = 1, scheduler: str | None = None) -> Generator[Pool]:
    """A pool for the tasks of one command.

    Args:
        jobs: processes on this machine; one means this very process. Results do not depend on it.
        scheduler: address of a running dask scheduler, `tcp://HOST:PORT`, whose workers are used instead.

    Raises:
        ConfigError: fewer than one job, or a scheduler that does not answer or whose workers have another pliant.
        MissingExtraError: a scheduler is named, but dask is not installed.
    """
    if not 1 <= jobs <= MOST_JOBS:
        raise ConfigError(f"a sweep takes 1 to {MOST_JOBS} jobs, got {jobs}")
    if scheduler is None and jobs == 1:
        yield in_this_process
        return
    with _interrupt_later() as interrupted:
        if scheduler is None:
            from pliant.experiments.workers import local_workers  # most commands need neither

            with local_workers(jobs, interrupted) as pool:
                yield pool
        else:
            from pliant.experiments.cluster import connected

            with connected(scheduler, interrupted) as pool:
                yield pool


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
