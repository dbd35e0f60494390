"""The first tab: play, pause, step, reset; case and controller; recording; which browser steers."""

from __future__ import annotations

import re
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import viser

from pliant.configuration import merged
from pliant.errors import PliantError
from pliant.experiments.base import CaseConfig
from pliant.experiments.registry import get_study, study_names
from pliant.live.link.messages import Begin, Flow, Message, Pulse, Ready, Record, StepOnce
from pliant.live.link.steering_lock import SteeringLock
from pliant.live.page.form import tell
from pliant.wiring.registry import find_controller

_TEXT_PERIOD = 0.3  # s
_NONE_YET: tuple[str, ...] = ("–",)
_SPEEDS = {"2×": 2.0, "1×": 1.0, "1/2": 0.5, "1/5": 0.2, "1/20": 0.05}


class RunControls:
    """The first tab.

    Args:
        server: the page.
        steering: which browser steers.
        send: takes a message for the loop.
        folder: where logs go.
    """

    def __init__(
        self, server: viser.ViserServer, steering: SteeringLock, send: Callable[[Message], None], folder: Path
    ) -> None:
        self._steering, self._send, self._folder = steering, send, folder
        self._flow = Flow()
        self._study, self._config = "", None
        self.recording: Path | None = None
        """log to which the recorder writes"""
        self.ticks = 0
        self._told: tuple[Path | None, bool, str | None] | None = None
        self._tell_at = 0.0
        """periods since the start"""
        gui = server.gui
        self._status = gui.add_markdown("*starting …*")
        self._play = gui.add_button("Pause", icon=viser.Icon.PLAYER_PAUSE, hint="Pauses or continues simulated time.")
        self._step = gui.add_button(
            "Step one period", icon=viser.Icon.PLAYER_TRACK_NEXT, hint="Runs one control period, while paused."
        )
        self._reset = gui.add_button(
            "Reset", icon=viser.Icon.ROTATE, hint="Starts this case again with the present settings."
        )
        self._speed = gui.add_dropdown(
            "speed", tuple(_SPEEDS), initial_value="1×", hint="Simulated time divided by wall time."
        )
        self._repeat = gui.add_checkbox("repeat", True, hint="Starts again when the run ends.")
        self._record = gui.add_button("Record", icon=viser.Icon.PLAYER_RECORD, color="red", hint="Writes an MCAP log.")
        self._choice = gui.add_folder("Case")
        with self._choice:
            names = tuple(study_names())
            self._studies = gui.add_dropdown("study", names, hint="Study, a family of cases.")
            self._cases = gui.add_dropdown("case", _NONE_YET, hint="Starts this case at once.")
            self._controllers = gui.add_dropdown("controller", _NONE_YET, hint="Starts the case again at once.")
        self._reason = gui.add_markdown("", visible=False)
        self._steer = gui.add_button(
            "Steer from this browser",
            icon=viser.Icon.STEERING_WHEEL,
            hint="Takes over the controls; other browsers can only watch.",
        )
        self._play.on_click(self._guarded(self._toggle))
        self._step.on_click(self._guarded(lambda: self._send(StepOnce())))
        self._reset.on_click(self._guarded(self.reset))
        self._record.on_click(self._guarded(self._switch_recording))
        self._speed.on_update(self._changed)
        self._repeat.on_update(self._changed)
        self._studies.on_update(self._choose_study)
        self._cases.on_update(self._choose_case)
        self._controllers.on_update(self._choose_controller)
        self._steer.on_click(lambda event: steering.take(event.client_id))

    # ------------------------------------------------------------------ from the loop

    def begin(self, ready: Ready) -> None:
        """A run begins."""
        self._study, self._config = ready.study, ready.config
        self._fill()
        for control in (self._reset, self._choice, self._repeat, self._record):
            control.visible = ready.restarts
        self._reason.visible = bool(ready.warnings)
        self._reason.content = "\n\n".join(f'<span style="color:#b8860b">{text}</span>' for text in ready.warnings[:3])

    def changed(self, config: CaseConfig) -> None:
        """The present configuration."""
        self._config = config

    def beat(self, pulse: Pulse) -> None:
        """Shows the state of the loop."""
        changed = (pulse.recording, pulse.playing, pulse.ended) != self._told
        self.recording, self.ticks = pulse.recording, pulse.ticks
        if not changed and time.monotonic() < self._tell_at:
            return  # updating text is expensive for a browser
        self._told, self._tell_at = (pulse.recording, pulse.playing, pulse.ended), time.monotonic() + _TEXT_PERIOD
        self._record.label = "Stop recording" if pulse.recording else "Record"
        playing = pulse.playing and pulse.ended is None
        self._play.label = "Pause" if playing else "Play"
        state = "playing" if playing else pulse.ended or "paused"
        log = f"<br/>recording **{pulse.recording.name}**" if pulse.recording else ""
        watchers = self._steering.watchers()
        others = f" · {watchers} watching" if watchers else ""
        self._status.content = (
            f"**t = {pulse.time:.2f} s** · {state}<br/>"
            f"real-time factor {pulse.real_time_factor:.2f}<br/>"
            f"missed deadlines {pulse.missed} of {pulse.ticks}{others}{log}"
        )

    def fail(self, reason: str) -> None:
        """Shows why a run stopped or could not start."""
        self._reason.visible = True
        self._reason.content = f'<span style="color:#c22f2f">{reason}</span>'
        self._status.content = "**stopped**"

    # ------------------------------------------------------------------ from the user

    def start(self, study: str, config: CaseConfig, *, fresh: bool = True) -> None:
        """Starts a run."""
        self._reason.visible = False
        self._study, self._config = study, config
        self._status.content = f"*building {study} {config.case} …*"
        self._send(self._flow)
        self._send(Begin(study, config, fresh))

    def reset(self) -> None:
        """Starts the same run again."""
        if self._config is not None:
            self.start(self._study, self._config, fresh=False)

    def _toggle(self) -> None:
        self._flow = replace(self._flow, playing=not self._flow.playing)
        self._send(self._flow)

    def _changed(self, event: viser.GuiEvent[Any]) -> None:
        flow = replace(self._flow, speed=_SPEEDS[self._speed.value], repeat=self._repeat.value)
        if flow == self._flow:
            return
        if not self._steering.allows(event.client_id):
            self._speed.value = next(name for name, speed in _SPEEDS.items() if speed == self._flow.speed)
            self._repeat.value = self._flow.repeat
            tell(event, *WATCHING)
            return
        self._flow = flow
        self._send(flow)

    def _switch_recording(self) -> None:
        if self.recording is not None:
            self._send(Record(None))
            return
        if self._config is not None:
            self._send(Record(free_name(self._folder, self._study, self._config)))

    def _choose_study(self, event: viser.GuiEvent[Any]) -> None:
        if self._studies.value == self._study or not self._mine(event):
            return
        study = get_study(self._studies.value)
        self.start(study.name, study.case(next(iter(study.cases))))

    def _choose_case(self, event: viser.GuiEvent[Any]) -> None:
        if self._config is None or self._cases.value == self._config.case or not self._mine(event):
            return
        self.start(self._study, get_study(self._study).case(self._cases.value))

    def _choose_controller(self, event: viser.GuiEvent[Any]) -> None:
        config = self._config
        if config is None or self._controllers.value == config.controller or not self._mine(event):
            return
        study = get_study(self._study)
        plain = study.case(config.case) if config.case in study.cases else config
        changes: dict[str, Any] = {"controller": self._controllers.value}
        if "control" in type(config).model_fields and not _same_kind(config.controller, self._controllers.value):
            changes["control"] = {}  # parameters of another controller
            plain = type(config).model_validate({**plain.model_dump(), "control": {}})
        try:
            self.start(self._study, merged(plain, changes))
        except PliantError as error:
            self._fill()
            self.fail(str(error))

    def _mine(self, event: viser.GuiEvent[Any]) -> bool:
        if event.client_id is None:
            return False  # the page itself filled in the present values
        if self._steering.allows(event.client_id):
            return True
        self._fill()
        tell(event, *WATCHING)
        return False

    def _fill(self) -> None:
        if self._config is None:
            return
        study = get_study(self._study)
        for control, names, chosen in (
            (self._studies, tuple(study_names()), study.name),  # and the task file that runs
            (self._cases, tuple(study.cases), self._config.case),
            (self._controllers, tuple(study.controllers), self._config.controller),
        ):
            names = names if chosen in names else (*names, chosen)
            if tuple(control.options) != names:
                control.options = names
            control.value = chosen

    def _guarded(self, action: Callable[[], None]) -> Callable[[viser.GuiEvent[Any]], None]:
        def act(event: viser.GuiEvent[Any]) -> None:
            if self._steering.allows(event.client_id):
                action()
            else:
                tell(event, *WATCHING)

        return act


WATCHING = ("You are watching", "Another browser steers. Take over on the tab Run.")


def free_name(folder: Path, study: str, config: CaseConfig) -> Path:
    """A file for a log that does not exist yet."""
    stem = re.sub(r"[^A-Za-z0-9_.-]+", "-", f"{study}_{config.case}_{config.controller}")
    number = 1
    while (path := folder / f"{stem}_{number:03d}.mcap").exists():
        number += 1
    return path


def _same_kind(before: str, after: str) -> bool:
    """Whether two controllers take the same parameters."""
    return find_controller(before).family == find_controller(after).family
