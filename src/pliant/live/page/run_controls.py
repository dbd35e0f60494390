"""The first tab: play, pause, step, reset; recording; which browser steers; why something is refused."""

from __future__ import annotations

import re
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import viser

from pliant.experiments.base import CaseConfig
from pliant.live.link.messages import Begin, Flow, Message, Pulse, Ready, Record, StepOnce
from pliant.live.link.steering_lock import SteeringLock
from pliant.live.page.form import WATCHING, tell

_TEXT_PERIOD = 0.3  # s
_RED = '<span style="color:#c22f2f">'
FIRST, TASK = -20.0, -10.0
"""order on the tab: of what stands at the top, and of the task below it; the other controls of time follow"""
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
        """periods since the start"""
        self._told: tuple[Path | None, bool, str | None, str] | None = None
        self._tell_at = 0.0
        gui = server.gui
        self._status = gui.add_markdown("*starting …*", order=FIRST)
        self._reason = gui.add_markdown("", visible=False, order=FIRST + 1)
        self._play = gui.add_button(
            "Pause", icon=viser.Icon.PLAYER_PAUSE, hint="Pauses or continues simulated time.", order=FIRST + 2
        )
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
        self._record = gui.add_button(
            "Record",
            icon=viser.Icon.PLAYER_RECORD,
            color="red",
            hint="Writes an MCAP log, until it is stopped or the run ends; a run that repeats ends it, too.",
        )
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
        self._steer.on_click(lambda event: steering.take(event.client_id))

    # ------------------------------------------------------------------ from the loop

    def begin(self, ready: Ready) -> None:
        """A run begins."""
        self._study, self._config = ready.study, ready.config
        for control in (self._reset, self._repeat, self._record):
            control.visible = ready.restarts
        lines = [f"{_RED}{ready.refused} What ran before runs again.</span>"] if ready.refused else []
        lines += [f'<span style="color:#b8860b">{text}</span>' for text in ready.warnings[:3]]
        self._reason.visible = bool(lines)
        self._reason.content = "\n\n".join(lines)

    def changed(self, config: CaseConfig) -> None:
        """The present configuration."""
        self._config = config

    def beat(self, pulse: Pulse) -> None:
        """Shows the state of the loop."""
        told = (pulse.recording, pulse.playing, pulse.ended, pulse.phase)
        changed = told != self._told
        self.recording, self.ticks = pulse.recording, pulse.ticks
        if not changed and time.monotonic() < self._tell_at:
            return  # updating text is expensive for a browser
        self._told, self._tell_at = told, time.monotonic() + _TEXT_PERIOD
        self._record.label = "Stop recording" if pulse.recording else "Record"
        playing = pulse.playing and pulse.ended is None
        self._play.label = "Pause" if playing else "Play"
        state = "playing" if playing else pulse.ended or "paused"
        log = f"<br/>recording **{pulse.recording.name}** until this run ends" if pulse.recording else ""
        phase = f" · {pulse.phase}" if pulse.phase else ""
        watchers = self._steering.watchers()
        others = f" · {watchers} watching" if watchers else ""
        self._status.content = (
            f"**t = {pulse.time:.2f} s** · {state}{phase}<br/>"
            f"real-time factor {pulse.real_time_factor:.2f} · {pulse.missed} of {pulse.ticks} deadlines missed"
            f"{others}{log}"
        )

    def fail(self, reason: str) -> None:
        """Shows why a run stopped or could not start."""
        self.refuse(reason)
        self._status.content = "**stopped**"

    def refuse(self, reason: str) -> None:
        """Shows why a choice cannot be; what runs goes on."""
        self._reason.visible = True
        self._reason.content = f"{_RED}{reason}</span>"

    # ------------------------------------------------------------------ from people

    def start(self, study: str, config: CaseConfig, fresh: bool = True) -> None:
        """Starts a run."""
        self._reason.visible = False
        self._study, self._config = study, config
        self._status.content = f"*building {study} {config.case} …*"
        self._send(self._flow)
        self._send(Begin(study, config, fresh))

    def reset(self) -> None:
        """Starts the same run again."""
        if self._config is not None:
            self.start(self._study, self._config, False)

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

    def _guarded(self, action: Callable[[], None]) -> Callable[[viser.GuiEvent[Any]], None]:
        def act(event: viser.GuiEvent[Any]) -> None:
            if self._steering.allows(event.client_id):
                action()
            else:
                tell(event, *WATCHING)

        return act


def free_name(folder: Path, study: str, config: CaseConfig) -> Path:
    """A file for a log that does not exist yet."""
    stem = re.sub(r"[^A-Za-z0-9_.-]+", "-", f"{study}_{config.case}_{config.controller}")
    number = 1
    while (path := folder / f"{stem}_{number:03d}.mcap").exists():
        number += 1
    return path
