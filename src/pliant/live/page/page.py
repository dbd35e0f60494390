"""The page of a running loop: shows messages of the loop, and sends it the user's changes."""

from __future__ import annotations

import threading
import time
from pathlib import Path
from typing import Any

from pliant.experiments.base import CaseConfig
from pliant.live.link.messages import (
    Message,
    Note,
    Picture,
    Pulse,
    Ready,
    Samples,
    SceneChanged,
)  # fmt: skip
from pliant.live.link.pipe import Link
from pliant.live.link.steering_lock import SteeringLock
from pliant.live.loop.tuning import wiring_of
from pliant.live.page.case_forms import CaseForms, FormPlaces
from pliant.live.page.choices import Choices
from pliant.live.page.error_trail import ErrorTrail
from pliant.live.page.estimates_panel import EstimatesPanel
from pliant.live.page.plots import Plots
from pliant.live.page.pushes import PushControls
from pliant.live.page.ready import has_desired_force, task_frames
from pliant.live.page.run_controls import TASK, RunControls
from pliant.live.page.scene_view import SceneView
from pliant.live.page.target import TargetControls
from pliant.live.page.task_controls import TaskControls
from pliant.live.server.web import PageServer

_SCENE_PERIOD = 1.0 / 30.0  # s
_CURVES_EVERY = 3  # pictures


class Page:
    """Everything on the page of a running loop.

    Args:
        server: where it is shown.
        link: to the loop.
        folder: where logs go.
    """

    def __init__(self, server: PageServer, link: Link, folder: Path) -> None:
        self._link = link
        self._viser = server.viser
        gui = self._viser.gui
        self.steering = SteeringLock(self._viser)
        self.view = SceneView(self._viser)
        self.plots = Plots(self._viser)
        tabs = gui.add_tab_group()
        with tabs.add_tab("Run"):
            self.run = RunControls(self._viser, self.steering, link.send, folder)
            self.task = TaskControls(self._viser, self.steering, link.send)
            self.choices = Choices(self._viser, self.steering, self.run.start, self.run.refuse, self.task.folder)
            self.trail = ErrorTrail(self._viser)
            self.estimates = EstimatesPanel(self._viser)
        for place, part in enumerate((self.task.folder, *self.trail.controls, self.choices.folder)):
            part.order = TASK + place
        tuning = tabs.add_tab("Tune")
        with tabs.add_tab("Touch"):
            with gui.add_folder("Target"):
                self.target = TargetControls(self._viser, self.steering, link.send)
            with gui.add_folder("Push"):
                self.pushes = PushControls(self._viser, self.steering, link.send)
            surfaces = gui.add_folder("Surfaces")
        places = FormPlaces(tuning, surfaces, tabs.add_tab("Robot"), tabs.add_tab("Case"))
        self.forms = CaseForms(gui, self.steering, link.send, self.run, self.choices, places)
        self._ready: Ready | None = None
        self._shown: tuple[str, dict[str, Any]] | None = None
        self._presses = False
        self._framed = False
        self._stop = threading.Event()

    @property
    def config(self) -> CaseConfig | None:
        """The present configuration; None before the first run."""
        return self.forms.config

    def serve(self) -> None:
        """Shows the loop until `stop` is called or the loop has ended."""
        pictures = 0
        while not self._stop.is_set() and not self._link.closed.is_set():
            self._link.wait(_SCENE_PERIOD)
            for message in self._link.take():
                self._show(message)
            pictures += 1
            if pictures % _CURVES_EVERY == 0:
                self.plots.draw()
            time.sleep(_SCENE_PERIOD)

    @property
    def lost(self) -> bool:
        """Whether the loop ended without a request."""
        return self._link.closed.is_set() and not self._stop.is_set()

    def mourn(self, text: str) -> None:
        """Shows in every browser that the loop has ended."""
        self._note(Note("failed", text))

    def stop(self) -> None:
        """Ends `serve`."""
        self._stop.set()

    def _show(self, message: Message) -> None:
        match message:
            case Ready():
                self._begin(message)
            case Picture() if self._ready is not None and message.run == self._ready.run:
                self._draw(message)
            case Samples():
                self._presses = self._presses or has_desired_force(message, self._ready)
                self.plots.extend(message.run, message.rows)
            case Pulse():
                self.run.beat(message)
            case SceneChanged() if self._ready is not None:
                self.view.stage(message.looks, self._ready.bodies, message.scene)
            case Note():
                self._note(message)
            case _:
                pass

    def _begin(self, ready: Ready) -> None:
        shown = (ready.study, wiring_of(ready.config))
        self._ready = ready
        self.run.begin(ready)
        self.choices.begin(ready.study, ready.config, offered=ready.restarts)
        self.plots.begin(ready.columns, ready.period)
        self.view.stage(ready.looks, ready.bodies, ready.scene)
        task = next((name for name in ready.frames if name in task_frames(ready)), ready.frames[-1])
        self.pushes.offer(ready.frames, task)
        self.trail.forget()
        if shown != self._shown:
            self._shown, self._presses, self._framed = shown, False, False
            self.target.reset()
            self.task.offer(ready.config.dials if ready.restarts else ())
            self.forms.rebuild(ready)
        self.forms.begin(ready)

    def _draw(self, picture: Picture) -> None:
        if not self._framed:
            self._framed = True
            self.view.frame_camera(picture.tool)
        self.view.draw(picture)
        self.trail.follow(picture.error, self.view.faces)
        self.estimates.show(picture)
        self.target.follow(picture, self._presses and self._ready is not None and not self._ready.config.dials)
        at = picture.contacts.get(self.pushes.frame)
        pushed = picture.pushes.get(self.pushes.frame)
        self.pushes.follow(picture, at[0] if at else pushed[0] if pushed else None)

    def _note(self, note: Note) -> None:
        titles = {"refused": "Refused", "failed": "Stopped", "recorded": "Recorded", "note": "Note"}
        colours: dict[str, Any] = {"refused": "orange", "failed": "red"}
        for client in self._viser.get_clients().values():
            client.add_notification(
                titles[note.kind], note.text, auto_close_seconds=8.0, color=colours.get(note.kind, "teal")
            )
        if note.kind == "failed":
            self.run.fail(note.text)
