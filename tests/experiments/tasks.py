"""What the processes of the tests do. A module of its own that imports little: it is read by every process."""

from __future__ import annotations

import math
import os
import signal
import time
from pathlib import Path


def work(task: int) -> float:
    if task < 0:
        os.kill(os.getpid(), signal.SIGKILL)
    return math.sin(task)


def odd(task: str) -> object:
    if task == "raises":
        raise ValueError("no")
    if task == "exits":
        os._exit(7)
    if task.startswith("/"):
        mark = Path(task)
        if not mark.exists():
            mark.touch()
            os.kill(os.getpid(), signal.SIGKILL)
    return (lambda: 0) if task == "cannot be sent" else None


def nap(task: float) -> float:
    time.sleep(task)
    return task


known = ["what the module says"]
"""what a fork has as its parent left it, and a process that imports the module anew as it stands here"""


def recall(_task: int) -> str:
    return known[-1]
