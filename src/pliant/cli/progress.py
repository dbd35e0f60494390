"""Progress bars, on standard error so that tables can be piped."""

from __future__ import annotations

from collections.abc import Callable, Generator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TaskProgressColumn, TextColumn, TimeRemainingColumn


@contextmanager
def progress_bar(console: Console, title: str) -> Generator[Callable[[float], None], None, None]:
    """A progress bar for one run; the function that it yields takes the completed share, 0…1."""
    columns = (TextColumn("{task.description}"), BarColumn(), TaskProgressColumn(), TimeRemainingColumn())
    with Progress(*columns, console=console, transient=True) as progress:
        task = progress.add_task(title, total=1.0)
        yield lambda share: progress.update(task, completed=share)


@contextmanager
def count_bar(console: Console, title: str, total: int, done: int = 0) -> Generator[Callable[[bool], None], None, None]:
    """A progress bar for many runs; the function that it yields is called after each run, with whether it failed.

    Args:
        console: where it is drawn.
        title: text before the bar.
        total: number of runs.
        done: number of runs completed before.
    """
    failed = 0
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeRemainingColumn(),
        TextColumn("{task.fields[failed]}", style="red"),
    )
    with Progress(*columns, console=console, transient=True) as progress:
        task = progress.add_task(title, total=total, completed=done, failed="")

        def step(this_failed: bool) -> None:
            nonlocal failed
            failed += this_failed
            progress.update(task, advance=1, failed=f"{failed} failed" if failed else "")

        yield step
