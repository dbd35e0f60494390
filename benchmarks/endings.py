"""How long whole commands take to end when something ends them: `python benchmarks/endings.py` [`--write PAGE`].

A server that is not dask, a scheduler or workers that die or stand still, Ctrl-C, and the page's loop killed.
"""

from __future__ import annotations

import argparse
import os
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

PLIANT = [sys.executable, "-c", "from pliant.cli import main\nif __name__ == '__main__': main()"]
RUN = ("polishing", "--case", "tables-2-3-4-delayed")  # several seconds each
LAST = 120.0  # s after which a command counts as never ending

GREETINGS: dict[str, bytes] = {
    "nothing at all": b"",
    "an SSH banner": b"SSH-2.0-OpenSSH_9.2p1 Debian-2\r\n",
    "zeros": bytes(4096),
    "a length of 2^64 - 1 bytes": b"\xff" * 64,
    "MySQL's greeting": b"J\0\0\0\n8.0.33\0abc",
    "HTTP": b"HTTP/1.1 400 Bad Request\r\n\r\n",
    "dask's first message, then nothing": b"",  # filled from a real scheduler
}


@dataclass(frozen=True)
class Ending:
    """How a command ended."""

    what: str
    seconds: float
    """from the start of the command where it is refused, else from what ended it"""
    code: int | None
    """its exit code; None: it had to be killed"""
    said: tuple[str, ...]
    """its lines on standard error, without progress bars"""
    limit: float
    """s that are promised for it on a machine without other work"""

    @property
    def kept(self) -> bool:
        return self.code is not None and self.seconds <= self.limit and "Traceback" not in "".join(self.said)


def start(*arguments: object) -> subprocess.Popen[str]:
    environment = os.environ | {"OMP_NUM_THREADS": "1", "COLUMNS": "160"}
    pipe = subprocess.PIPE
    call = [*PLIANT, *map(str, arguments)]
    return subprocess.Popen(call, stdout=pipe, stderr=pipe, text=True, env=environment, start_new_session=True)


def ended(what: str, process: subprocess.Popen[str], since: float, limit: float) -> Ending:
    """Waits for a command."""
    try:
        _, errors = process.communicate(timeout=LAST)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        process.communicate()
        return Ending(what, time.monotonic() - since, None, (), limit)
    lines = [line for line in errors.splitlines() if line.startswith(("error:", "failed:", "interrupted:", "Trace"))]
    return Ending(what, time.monotonic() - since, process.returncode, tuple(lines), limit)


@contextmanager
def server(greeting: bytes) -> Iterator[str]:
    """Something that listens, says this to whoever comes, and nothing more."""
    with socket.create_server(("127.0.0.1", 0)) as door:
        lines: list[socket.socket] = []

        def serve() -> None:
            while True:
                try:
                    line, _ = door.accept()
                    lines.append(line)
                    line.sendall(greeting)
                except OSError:
                    return

        threading.Thread(target=serve, daemon=True).start()
        yield f"tcp://127.0.0.1:{door.getsockname()[1]}"
        door.shutdown(socket.SHUT_RDWR)
        for line in lines:
            line.close()


@contextmanager
def cluster(workers: int) -> Iterator[tuple[str, list[subprocess.Popen[bytes]]]]:
    """A dask scheduler and its workers, each a process of its own."""
    with socket.create_server(("127.0.0.1", 0)) as free:
        address = f"tcp://127.0.0.1:{free.getsockname()[1]}"
    quiet: dict[str, Any] = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    dask = [sys.executable, "-m", "distributed.cli.dask_scheduler", "--host", address, "--no-dashboard"]
    work = [sys.executable, "-m", "distributed.cli.dask_worker", address, "--nthreads", "1", "--no-nanny"]
    started = [subprocess.Popen(dask, **quiet)]
    try:
        first_message(address)
        started += [subprocess.Popen([*work, "--no-dashboard"], **quiet) for _ in range(workers)]
        yield address, started
    finally:
        for process in reversed(started):
            process.send_signal(signal.SIGCONT)
            process.kill()
            process.wait(20)


def first_message(address: str) -> bytes:
    """What a scheduler says first, once it is there."""
    until = time.monotonic() + 30.0
    while True:
        try:
            with socket.create_connection(("127.0.0.1", int(address.rsplit(":", 1)[1])), timeout=2.0) as line:
                time.sleep(0.3)
                return line.recv(1 << 16)
        except OSError:
            if time.monotonic() > until:
                raise
            time.sleep(0.1)


def rows(folder: Path, process: subprocess.Popen[str]) -> None:
    """Waits until a sweep has its first row."""
    import pyarrow.parquet as pq

    file = folder / "results.parquet"
    while process.poll() is None and not (file.exists() and pq.read_metadata(file).num_rows):
        time.sleep(0.05)


def refused(folder: Path) -> Iterator[Ending]:
    """Servers that are something else than a scheduler with workers."""
    limit = 15.0
    with cluster(0) as (address, [scheduler]):
        greetings = GREETINGS | {"dask's first message, then nothing": first_message(address)}
        study = ("study", *RUN, "--out", folder / "refused", "--scheduler")
        yield ended("a scheduler without workers", start(*study, address), time.monotonic(), limit)
        scheduler.send_signal(signal.SIGSTOP)
        yield ended("a scheduler that stands still", start(*study, address), time.monotonic(), limit)
    for what, greeting in greetings.items():
        with server(greeting) as address:
            yield ended(f"a server that says {what}", start(*study, address), time.monotonic(), limit)
    yield ended("a port where nobody listens", start(*study, address), time.monotonic(), limit)
    with cluster(1) as (address, [_, worker]):
        time.sleep(3.0)  # until it has reported
        worker.send_signal(signal.SIGSTOP)
        yield ended("a scheduler whose worker stands still", start(*study, address), time.monotonic(), limit)


def broken_off(folder: Path) -> Iterator[Ending]:
    """Sweeps on a cluster that goes away, and Ctrl-C."""
    which: dict[str, Callable[[list[subprocess.Popen[bytes]]], None]] = {
        "the scheduler killed": lambda parts: parts[0].kill(),
        "the scheduler stands still": lambda parts: parts[0].send_signal(signal.SIGSTOP),
        "its only worker killed": lambda parts: parts[1].kill(),
    }
    for what, act in which.items():
        with cluster(1) as (address, parts):
            out = folder / what.replace(" ", "-")
            process = start("study", *RUN, "--scheduler", address, "--out", out)
            rows(out, process)
            act(parts)
            yield ended(f"a sweep on a cluster, {what}", process, time.monotonic(), 15.0)
    sweeps = {"in one process": ("--jobs", 1), "in two processes": ("--jobs", 2), "on a cluster": None}
    for where, options in sweeps.items():
        with ExitStack() as stack:
            out = folder / where.replace(" ", "-")
            options = options or ("--scheduler", stack.enter_context(cluster(1))[0])
            process = start("study", *RUN, *options, "--out", out)
            rows(out, process)
            yield interrupted(f"Ctrl-C, a sweep {where}", process)
    for after in (0.7, 2.0, 5.0):
        process = start("run", *RUN, "--out", folder / f"run{after}")
        time.sleep(after)
        yield interrupted(f"Ctrl-C, a run, {after:g} s after its start", process)


def interrupted(what: str, process: subprocess.Popen[str]) -> Ending:
    since = time.monotonic()
    os.killpg(process.pid, signal.SIGINT)  # as a terminal does: to all processes of the command
    return ended(what, process, since, 5.0)


def table(endings: list[Ending]) -> str:
    """In Markdown."""
    lines = ["| what ends the command | s | at most | exit code |", "|---|---:|---:|---:|"]
    for end in endings:
        lines.append(
            f"| {end.what} | {end.seconds:.1f} | {end.limit:g} | {end.code if end.code is not None else '∞'} |"
        )
    return "\n".join(lines)


BEGIN, END = "<!-- endings: written by benchmarks/endings.py -->", "<!-- end of endings -->"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--write", type=Path, help="page that holds the table")
    chosen = parser.parse_args()
    found: list[Ending] = []
    with tempfile.TemporaryDirectory() as folder:
        for part in (refused, broken_off):
            for end in part(Path(folder)):
                print(f"{end.seconds:5.1f} s  exit {end.code}  {end.what}: {' | '.join(end.said)}", flush=True)
                found.append(end)
    if chosen.write is not None:
        before, rest = chosen.write.read_text(encoding="utf-8").split(BEGIN)
        _, after = rest.split(END)
        chosen.write.write_text(f"{before}{BEGIN}\n\n{table(found)}\n\n{END}{after}", encoding="utf-8")
    return sum(not end.kept for end in found)


if __name__ == "__main__":
    sys.exit(main())
