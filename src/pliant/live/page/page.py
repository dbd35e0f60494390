"""The page of a running loop: shows messages of the loop, and sends it the user's changes."""

from __future__ import annotations

import threading
import time
from pathlib import Path
from typing import Any

import viser

from pliant.configuration import merged
from pliant.experiments.base import CaseConfig
from pliant.live.link.messages import (
    Flaws,
    Message,
    Note,
    Parameters,
    Picture,
    Pulse,
    Ready,
    Samples,
    SceneChanged,
    Surroundings,
)  # fmt: skip
from pliant.live.link.pipe import Link
from pliant.live.link.steering_lock import SteeringLock
from pliant.live.loop.tuning import online_fields, online_group, parameters_of
from pliant.live.page.estimates_panel import EstimatesPanel
from pliant.live.page.fields import Path as Place
from pliant.live.page.fields import group_of, nested
from pliant.live.page.form import Form
from pliant.live.page.plots import Plots
from pliant.live.page.pushes import PushControls
from pliant.live.page.ready import has_desired_force, task_frames
from pliant.live.page.run_controls import RunControls
from pliant.live.page.scene_view import SceneView
from pliant.live.page.target import TargetControls
from pliant.live.page.task_controls import TaskControls
from pliant.live.page.world_form import SceneForm
from pliant.live.server.web import PageServer
from pliant.simulation import Imperfections

_SCENE_PERIOD = 1.0 / 30.0  # s
_CURVES_EVERY = 3  # pictures
_NOT_A_FORM = frozenset({"case", "controller", "control", "variant"})


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
            self.estimates = EstimatesPanel(self._viser)
        self._tuning_tab = tabs.add_tab("Tune")
        with tabs.add_tab("Touch"):
            with gui.add_folder("Target"):
                self.target = TargetControls(self._viser, self.steering, link.send)
            with gui.add_folder("Push"):
                self.pushes = PushControls(self._viser, self.steering, link.send)
            self._world_folder = gui.add_folder("Surfaces")
        self._robot_tab = tabs.add_tab("Robot")
        self._case_tab = tabs.add_tab("Case")
        self._forms: list[Any] = []
        self._ready: Ready | None = None
        self._shown: tuple[str, str, str] | None = None
        self._config: CaseConfig | None = None
        self._wanted: CaseConfig | None = None
        self._scene: SceneForm | None = None
        self._flaws: Imperfections | None = None
        self._presses = False
        self._framed = False
        self._stop = threading.Event()

    @property
    def config(self) -> CaseConfig | None:
        """The present configuration; None before the first run."""
        return self._config

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
        shown = (ready.study, ready.config.case, ready.config.controller)
        self._config = ready.config
        self._ready = ready
        self.run.begin(ready)
        self.plots.begin(ready.columns, ready.period)
        self.view.stage(ready.looks, ready.bodies, ready.scene)
        task = next((name for name in ready.frames if name in task_frames(ready)), ready.frames[-1])
        self.pushes.offer(ready.frames, task)
        if shown != self._shown:
            self._shown, self._presses, self._framed = shown, False, False
            self.target.reset()
            self.task.offer(ready.config.dials if ready.restarts else ())
            self._rebuild_forms(ready)

    def _draw(self, picture: Picture) -> None:
        if not self._framed:
            self._framed = True
            self.view.frame_camera(picture.tool)
        self.view.draw(picture)
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

    # ------------------------------------------------------------------ controls made from configurations

    def _rebuild_forms(self, ready: Ready) -> None:
        for form in self._forms:
            form.remove()
        self._forms = []
        self._tuning_form(ready.config)
        self._scene = None if ready.scene is None else SceneForm(ready.scene)
        if self._scene is not None and ready.scene is not None and ready.scene.things:
            with self._world_folder:
                self._forms.append(Form(self._viser.gui, self.steering, self._scene.group(), self._change_scene))
        self._flaws = ready.flaws
        if ready.flaws is not None:
            flaws = group_of(ready.flaws, skip=frozenset({"joint_damping"}))
            with self._robot_tab:
                self._forms.append(Form(self._viser.gui, self.steering, flaws, self._change_flaws, expanded=False))
        if ready.restarts:
            self._case_form(ready.config)

    def _tuning_form(self, config: CaseConfig) -> None:
        parameters = parameters_of(config)
        with self._tuning_tab:
            gui = self._viser.gui
            if parameters is not None and "control" in type(config).model_fields:
                self._forms.append(Form(gui, self.steering, group_of(parameters), self._change_parameters))
            elif online_fields(config):
                self._forms.append(Form(gui, self.steering, online_group(config), self._change_online))
            else:
                self._forms.append(gui.add_markdown("This controller has no parameters that can be changed."))

    def _case_form(self, config: CaseConfig) -> None:
        self._wanted = config
        gui = self._viser.gui
        with self._case_tab:
            button = gui.add_button(
                "Start with these values", icon=viser.Icon.PLAYER_PLAY, hint="Builds the case anew."
            )
            self._forms.append(button)
            self._forms.append(
                Form(gui, self.steering, group_of(config, skip=_NOT_A_FORM), self._change_case, expanded=False)
            )
        button.on_click(self._start_wanted)

    def _start_wanted(self, event: viser.GuiEvent[Any]) -> None:
        if self._wanted is not None and self._ready is not None and self.steering.allows(event.client_id):
            control = getattr(self._config, "control", None)
            wanted = self._wanted if control is None else merged(self._wanted, {"control": control})
            self.run.start(self._ready.study, wanted, fresh=False)

    def _change_parameters(self, place: Place, value: Any) -> None:
        if self._config is None:
            return
        self._retune(merged(self._config, nested(("control", *place), value)))

    def _change_online(self, place: Place, value: Any) -> None:
        if self._config is not None:
            self._retune(merged(self._config, nested(place, value)))

    def _retune(self, config: CaseConfig) -> None:
        parameters_of(config)  # raises an error if the parameters do not fit together
        self._config = config
        self.run.changed(config)
        self._link.send(Parameters(self._config))

    def _change_scene(self, place: Place, value: Any) -> None:
        if self._scene is not None:
            self._link.send(Surroundings(self._scene.changed(place, value)))

    def _change_flaws(self, place: Place, value: Any) -> None:
        if self._flaws is not None:
            self._flaws = merged(self._flaws, nested(place, value))
            self._link.send(Flaws(self._flaws))

    def _change_case(self, place: Place, value: Any) -> None:
        if self._wanted is not None:
            self._wanted = merged(self._wanted, nested(place, value))
