"""A page for one run of the command line. The run can be watched and steered, and ends as it would without a page."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterable, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pliant.experiments.base import CaseConfig, Experiment, Study
from pliant.interfaces import Observer
from pliant.live.link.messages import Flow
from pliant.live.link.pipe import Link
from pliant.live.loop.pace import Pace
from pliant.live.loop.session import Session
from pliant.live.server.launch import page_process


@dataclass(frozen=True, slots=True)
class RunPage:
    """What `run_case` needs so that a page can follow its loop."""

    experiment: Experiment
    observers: Sequence[Observer]
    pace: Callable[[Iterable[object]], Iterable[object]]


@contextmanager
def page_for_run(
    study: Study[Any],
    config: CaseConfig,
    experiment: Experiment,
    host: str,
    port: int,
    folder: Path,
    announce: Callable[[str, bool], None],
) -> Generator[RunPage]:
    """A page for one run of this process; it is closed when the run ends.

    Args:
        study, config, experiment: the run.
        host, port: where browsers connect.
        folder: where the run writes.
        announce: told the address, and whether other machines can reach it.

    Raises:
        ConfigError: the address cannot be listened at, or the plant cannot be shown.
    """
    with page_process(host, port, folder, announce) as link:
        session = Session(study, config, link.send, 1, experiment=experiment, restarts=False)
        pace = Pace(session.plant.period, lambda: _attend(session, pace, link), link.wait)
        session.observe(pace)
        yield RunPage(session.experiment, [session.watch], pace)
        session.watch.refresh(now=True)


def _attend(session: Session, pace: Pace, link: Link) -> None:
    session.announce()
    if link.closed.is_set():
        pace.flow = Flow()  # without a page nobody could continue a paused run
        return
    if not pace.flow.playing:
        session.watch.refresh()
    for message in link.take() if link.waiting else ():
        session.obey(message, pace)
