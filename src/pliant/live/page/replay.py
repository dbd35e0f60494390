"""A log on the page, with a time slider."""

from __future__ import annotations

import signal
import threading
import time
from collections.abc import Callable
from pathlib import Path
from types import FrameType
from typing import Any

import numpy as np
import viser

from pliant.live.link.steering_lock import SteeringLock
from pliant.live.page.error_trail import ErrorTrail
from pliant.live.page.estimates_panel import EstimatesPanel
from pliant.live.page.logged_scene import LoggedScene
from pliant.live.page.plots import Plots
from pliant.live.page.scene_view import SceneView
from pliant.live.server.web import PageServer
from pliant.telemetry.log import Log

_PERIOD = 1.0 / 30.0  # s
_SPEEDS = {"4×": 4.0, "2×": 2.0, "1×": 1.0, "1/5": 0.2}


class ReplayPage:
    """The page of a log.

    Args:
        server: where it is shown.
        shown: the log.
    """

    def __init__(self, server: PageServer, shown: LoggedScene) -> None:
        self._shown = shown
        self._viser = server.viser
        self.steering = SteeringLock(self._viser)
        self.view, self.plots = SceneView(self._viser), Plots(self._viser)
        self._start, self._end = float(shown.time[0]), float(shown.time[-1])
        self._playing = True
        self._stop = threading.Event()
        gui = self._viser.gui
        self.header = _header(shown.log)
        """text about the log"""
        gui.add_markdown(self.header)
        span = max(self._end - self._start, 1e-3)
        self._slider = gui.add_slider(
            "time [s]", self._start, self._start + span, 0.001, self._start, hint="Drag to any time."
        )
        self._play = gui.add_button("Pause", icon=viser.Icon.PLAYER_PAUSE)
        self._speed = gui.add_dropdown("speed", tuple(_SPEEDS), initial_value="1×")
        self._status = gui.add_markdown("")
        self.trail = ErrorTrail(self._viser)
        self.estimates = EstimatesPanel(self._viser)
        self._play.on_click(self._toggle)
        self._slider.on_update(self._seek)
        self._now = self._start
        self._ours = self._start
        self.plots.begin(shown.columns.names, float(np.median(np.diff(shown.time))) if len(shown.time) > 1 else 1e-3)
        self.view.stage(shown.looks, int(shown.model.nbody), shown.scene)
        self.view.frame_camera(shown.picture(self._start).tool)

    @property
    def time(self) -> float:
        """s of the log, now shown."""
        return self._now

    def serve(self) -> None:
        """Plays until `stop` is called."""
        count, before = 0, time.monotonic()
        while not self._stop.is_set():
            now = time.monotonic()
            if self._playing:
                self._now += (now - before) * _SPEEDS[self._speed.value]
                if self._now > self._end:
                    self._now = self._start
                    self.trail.forget()
                self._ours = round(self._now, 3)
                self._slider.value = self._ours
            before = now
            picture = self._shown.picture(self._now)
            self.view.draw(picture)
            self.trail.follow(picture.error, self.view.faces)
            self.estimates.show(picture)
            if count % 3 == 0:
                self.plots.show(self._shown.curves(self._now, 10.0))
                self._status.content = f"**t = {picture.time:.3f} s**"
            count += 1
            self._stop.wait(max(0.0, _PERIOD - (time.monotonic() - now)))

    def stop(self) -> None:
        """Ends `serve`."""
        self._stop.set()

    def _toggle(self, event: viser.GuiEvent[Any]) -> None:
        if self.steering.allows(event.client_id):
            self._playing = not self._playing
            self._play.label = "Pause" if self._playing else "Play"

    def _seek(self, event: viser.GuiEvent[Any]) -> None:
        if event.client_id is None or not self.steering.allows(event.client_id):
            return
        self._playing, self._play.label = False, "Play"
        self._now = float(self._slider.value)


def _header(log: Log) -> str:
    info = log.info
    lines = [f"**{Path(log.source).name}**", f"{info.study} · {info.case} · {info.controller} · {info.robot}"]
    if log.failure:
        lines.append(f'<span style="color:#c22f2f">ended early: {log.failure}</span>')
    if log.truncated:
        lines.append('<span style="color:#c22f2f">the file is truncated; what could be read is shown</span>')
    return "<br/>".join(lines)


def serve_replay(path: Path, host: str, port: int, announce: Callable[[PageServer], None]) -> None:
    """Shows a log until the process is interrupted.

    Raises:
        OutputError: the log cannot be read.
        ConfigError: the address cannot be listened at.
    """
    shown = LoggedScene(Log.open(path))
    with PageServer(host, port) as server:
        page = ReplayPage(server, shown)

        def end(number: int, frame: FrameType | None) -> None:
            page.stop()

        before = signal.signal(signal.SIGTERM, end)
        announce(server)
        try:
            page.serve()
        except KeyboardInterrupt:
            page.stop()
        finally:
            signal.signal(signal.SIGTERM, before)
