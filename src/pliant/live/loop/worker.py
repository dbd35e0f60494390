"""The process that runs loops for a page."""

from __future__ import annotations

import signal
from dataclasses import replace
from multiprocessing.connection import Connection

from pliant.errors import PliantError
from pliant.experiments.registry import get_study
from pliant.experiments.runner import run_length
from pliant.live.link.messages import Begin, Flow, Message, Note
from pliant.live.link.pipe import Link
from pliant.live.loop.pace import Pace
from pliant.live.loop.requests import Requests
from pliant.live.loop.session import Session
from pliant.live.loop.tuning import wiring_of


def main(connection: Connection) -> None:
    """Runs what the page requests, until the page is closed."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C reaches the page, which closes the link
    link = Link(connection)
    worker = Worker(link)
    try:
        worker.serve()
    finally:
        link.close()


class Worker:
    """Runs one loop after another.

    Args:
        link: to the page.
    """

    def __init__(self, link: Link) -> None:
        self._link = link
        self._begin: Begin | None = None
        self._flow = Flow()
        self._runs = 0
        self._session: Session | None = None

    def serve(self) -> None:
        """Returns when the page is closed."""
        while not self._link.closed.is_set():
            begin, self._begin = self._begin, None
            if begin is not None:
                self._run(begin)
                continue
            self._link.wait(0.1)
            self._sort(self._link.take(), None, None)

    def _run(self, begin: Begin) -> None:
        self._runs += 1
        try:
            session = self._wire(begin)
        except PliantError as error:
            self._refuse(begin, str(error))
            return
        self._session = session
        pace = Pace(session.plant.period, lambda: self._attend(session, pace), self._link.wait)
        pace.flow = replace(self._flow)
        session.observe(pace)
        length = run_length(begin.config, session.experiment)
        wired = session.experiment
        observers = [session.recorder, session.watch]
        failure: str | None = None
        try:
            failure = wired.run(pace(session.periods(length)), observers).failure
        except PliantError as error:
            failure = str(error)
        finally:
            session.finish_recording(failure or ("stopped" if self._link.closed.is_set() else None))
        self._flow = pace.flow
        if self._begin is None:
            self._after(begin, session, failure)

    def _refuse(self, begin: Begin, reason: str) -> None:
        """Says why a run cannot be; the one before it, if there was one, begins again."""
        if self._session is None or begin.refused:
            self._link.send(Note("failed", reason))
            return
        before = self._session
        self._link.send(Note("refused", reason))
        self._begin = Begin(before.study.name, before.config, fresh=False, refused=reason)

    def _wire(self, begin: Begin) -> Session:
        """The loop of a run. One that differs in the controller's parameters alone is not built again."""
        study, before = get_study(begin.study), self._session
        if before is None or before.study.name != begin.study or wiring_of(before.built_for) != wiring_of(begin.config):
            return Session(study, begin.config, self._link.send, self._runs)
        requests = Requests() if begin.fresh else replace(before.shared.requests, pull=None)
        session = Session(
            study, before.built_for, self._link.send, self._runs, experiment=before.built, requests=requests
        )
        session.refused = begin.refused
        if begin.config != before.built_for:
            session.retune(begin.config)
        return session

    def _after(self, begin: Begin, session: Session, failure: str | None) -> None:
        """Waits after the end of a run for the next request."""
        session.watch.refresh(now=True)
        if failure is not None:
            self._link.send(Note("failed", failure))
        elif self._flow.repeat and not self._link.closed.is_set():
            self._begin = Begin(begin.study, session.config, fresh=False)
            return
        self._link.send(session.watch.pulse(ended=failure or "the run is over"))

    def _attend(self, session: Session, pace: Pace) -> None:
        """Between two periods."""
        if self._link.closed.is_set():
            pace.stopped = True
            return
        session.announce()
        if not pace.flow.playing:
            session.watch.refresh()
        if session.recorder.trouble:
            self._link.send(Note("failed", session.recorder.trouble))
            session.recorder.trouble = ""
        if self._link.waiting:
            self._sort(self._link.take(), session, pace)

    def _sort(self, messages: list[Message], session: Session | None, pace: Pace | None) -> None:
        for message in messages:
            if isinstance(message, Begin):
                self._begin = message
                if pace is not None:
                    pace.stopped = True
            elif session is not None and pace is not None:
                session.obey(message, pace)
            elif isinstance(message, Flow):
                self._flow = message
