"""A pool of processes on this machine, one task each at a time. A process that dies is replaced; only its task is
affected.

`concurrent.futures` abandons all tasks when one process dies; here each process has a pipe of its own, so that it is
known which task it had.

Where it is safe, processes are forks: they start at once, and have what this process has imported and worked out, the
postures of a reference for example. Elsewhere they are spawned: each imports and works out for itself.
"""

from __future__ import annotations

import multiprocessing as mp
import os
import pickle
import signal
import sys
import threading
import warnings
from collections import Counter, deque
from collections.abc import Callable, Generator, Iterator, Sequence
from contextlib import contextmanager, suppress
from multiprocessing import resource_tracker
from multiprocessing.connection import Connection, wait
from typing import Any, Literal, TypeVar

from pliant.errors import RunFailedError
from pliant.experiments.pool import Lost, Pool

T = TypeVar("T")
R = TypeVar("R")
DEATHS = 3
"""how often the process of a task may die before the task counts as lost"""
_LOOK = 0.2  # s between two looks for Ctrl-C
_OWN_THREADS = ("cupy", "jax", "tensorflow", "torch")
"""libraries that do not work in a fork of a process in which they have started"""


def start_method() -> Literal["fork", "spawn"]:
    """How a process is started now: fork on Linux, where this process runs no other Python thread (which may hold a
    lock that would stay locked in the fork) and no library that cannot be forked."""
    threads = len(sys._current_frames())  # pyright: ignore[reportPrivateUsage] (`threading` lists its own alone)
    alone = threads == 1 and threading.current_thread() is threading.main_thread()
    return "fork" if sys.platform == "linux" and alone and sys.modules.keys().isdisjoint(_OWN_THREADS) else "spawn"


@contextmanager
def local_workers(jobs: int, interrupted: threading.Event) -> Generator[Pool]:
    """A pool of processes, as many as there are cores at once, others when there is work for them; all end with it.

    Args:
        jobs: how many processes.
        interrupted: set when the user asked to stop: finished tasks are returned, then KeyboardInterrupt is raised.
    """
    crew = _Crew(jobs, interrupted)
    try:
        yield crew
    finally:
        crew.dismiss()


class _Crew:
    def __init__(self, jobs: int, interrupted: threading.Event) -> None:
        self._jobs, self._interrupted = jobs, interrupted
        self._workers: dict[Connection, _Worker] = {}
        self._stillborn = 0  # consecutive processes that died without a task
        self._start(min(jobs, os.cpu_count() or 1))  # before a progress bar has a thread

    def __call__(self, function: Callable[[T], R], tasks: Sequence[T]) -> Iterator[tuple[int, R | Lost]]:
        """Raises RunFailedError if no process can be started, KeyboardInterrupt after Ctrl-C."""
        waiting, deaths = deque(range(len(tasks))), Counter[int]()
        left = len(tasks)
        try:
            while left:
                self._employ(waiting, function, tasks, left)
                for worker in self._listen():
                    index, answer = worker.task, worker.hear()
                    if answer is not None:
                        self._stillborn = 0
                        worker.task = None
                        self._employ(waiting, function, tasks, left)  # it works on while the answer is processed
                    else:
                        how = self._bury(worker)
                        if index is None:
                            self._check_birth(how)
                        else:
                            deaths[index] += 1
                            answer = self._again(index, waiting, deaths[index], how)
                    if index is not None and answer is not None:
                        left -= 1
                        yield index, answer.content
        finally:
            for worker in [worker for worker in self._workers.values() if worker.task is not None]:
                self._bury(worker)

    def dismiss(self) -> None:
        """Ends all processes."""
        for worker in list(self._workers.values()):
            self._bury(worker)

    def _employ(self, waiting: deque[int], function: Callable[[T], R], tasks: Sequence[T], left: int) -> None:
        self._start(min(self._jobs, left))
        for worker in self._workers.values():
            if waiting and worker.ready and worker.task is None and not self._interrupted.is_set():
                index = waiting.popleft()
                worker.give(index, pickle.dumps((function, tasks[index])))

    def _start(self, wanted: int) -> None:
        while len(self._workers) < wanted:
            worker = _Worker(list(self._workers))
            self._workers[worker.pipe] = worker

    def _listen(self) -> list[_Worker]:
        """The processes that have sent something or died. Ctrl-C takes effect after all finished tasks have been
        returned."""
        while True:
            heard = wait(list(self._workers), timeout=0.0 if self._interrupted.is_set() else _LOOK)
            if heard:
                found = [self._workers[pipe] for pipe in heard if isinstance(pipe, Connection)]
                if not self._interrupted.is_set() or any(worker.task is not None for worker in found):
                    return found
            if self._interrupted.is_set():
                raise KeyboardInterrupt

    def _again(self, index: int, waiting: deque[int], deaths: int, how: str) -> _Answer | None:
        if deaths < DEATHS:
            waiting.appendleft(index)
            return None
        return _Answer(Lost(f"its process died, {deaths} times in a row ({how})"))

    def _check_birth(self, how: str) -> None:
        self._stillborn += 1
        if self._stillborn >= DEATHS * self._jobs:
            raise RunFailedError(
                f"no process for the runs can be started: {self._stillborn} ended at once ({how}); a script"
                " with a sweep"
                " needs `if __name__ == '__main__':` around it; what had finished before is kept"
            )

    def _bury(self, worker: _Worker) -> str:
        del self._workers[worker.pipe]
        return worker.end()


class _Answer:
    """Answer of a process; a class, because a task may return None."""

    def __init__(self, content: Any) -> None:
        self.content = content


class _Worker:
    """A process, the pipe to it, and the task that it has."""

    def __init__(self, others: Sequence[Connection]) -> None:
        """Args: others: this process's ends of the pipes to other processes."""
        method = start_method()
        context = mp.get_context("fork") if method == "fork" else mp.get_context("spawn")
        self.pipe, theirs = context.Pipe()
        self.task: int | None = None
        self.ready = False
        inherited = (self.pipe, *others) if method == "fork" else ()
        self._process = context.Process(target=_serve, args=(theirs, *inherited), daemon=True)
        with _shielded(), warnings.catch_warnings():
            # Python 3.12 warns of system threads, too: those of BLAS, which begin anew in a fork
            warnings.simplefilter("ignore", DeprecationWarning)
            self._process.start()
        theirs.close()  # its end is now the only one: the pipe ends with the process

    def give(self, index: int, message: bytes) -> None:
        self.task = index
        with suppress(OSError):  # it died while idle: the pipe reports it next
            self.pipe.send_bytes(message)

    def hear(self) -> _Answer | None:
        """Its message; None if it died."""
        try:
            answer = pickle.loads(self.pipe.recv_bytes())
        except (EOFError, OSError):
            return None
        self.ready = True
        return _Answer(answer)

    def end(self) -> str:
        """Ends the process. Returns how it had ended by itself, if it had."""
        if self.pipe.poll():  # its end is closed, or the pool is closing
            self._process.join(1.0)
        code = self._process.exitcode
        self._process.kill()
        self._process.join()
        self.pipe.close()
        return signal.Signals(-code).name if code is not None and code < 0 else f"exit code {code}"


def _serve(pipe: Connection, *inherited: Connection) -> None:
    """Main function of a process: runs tasks until its pipe is closed. Args: inherited: ends that a fork has, too."""
    for end in inherited:
        end.close()
    # a terminal sends it to all processes; the command ends its processes itself
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_die_with_parent, daemon=True).start()
    with suppress(EOFError, OSError):
        pipe.send_bytes(pickle.dumps(None))
        while True:
            message = pipe.recv_bytes()
            try:
                function, task = pickle.loads(message)
                answer = pickle.dumps(function(task))
            except Exception as error:
                answer = pickle.dumps(Lost(f"the worker could not run it: {type(error).__name__}: {error}"))
            pipe.send_bytes(answer)


def _die_with_parent() -> None:
    parent = mp.parent_process()
    assert parent is not None
    parent.join()
    os._exit(1)


@contextmanager
def _shielded() -> Generator[None]:
    """Processes started in here never see Ctrl-C, and spawned ones compute on one thread each."""
    resource_tracker.ensure_running()  # the process would unblock the signal
    threads = os.environ.get("OMP_NUM_THREADS")
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
        if threads is None:
            del os.environ["OMP_NUM_THREADS"]
