"""The observer that shows a loop to the page."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from pliant.live.link.messages import Message, Picture, Pulse, Samples
from pliant.live.loop.pace import PaceReport
from pliant.live.loop.requests import SharedState
from pliant.live.page.curves import Columns
from pliant.live.page.picture import picture
from pliant.robot import Robot
from pliant.signals import Tick
from pliant.simulation import MujocoPlant
from pliant.visual_shapes import Poser

SCENE_PERIOD = 1.0 / 30.0  # s of wall time
CURVE_PERIOD = 0.1  # s of wall time between two messages with samples
_SAMPLE_PERIOD = 0.02  # s of simulated time between two points of a curve


class Watch:
    """Sends pictures at 30 Hz and samples of the curves at 10 Hz; other ticks cost almost nothing.

    Args:
        send: takes a message and returns at once.
        robot: of the loop.
        plant: its simulation.
        shared: state of the requests.
        run: number of this run, sent with the samples.
    """

    def __init__(
        self, send: Callable[[Message], None], robot: Robot, plant: MujocoPlant, shared: SharedState, run: int
    ) -> None:
        self._send, self._robot, self._shared, self._run = send, robot, shared, run
        self._body, self._ghost = Poser(plant.model, robot.n), Poser(plant.model, robot.n)
        self.report: Callable[[], PaceReport] = lambda: PaceReport(0.0, True)
        self.recording: Callable[[], Path | None] = lambda: None
        self.period = plant.period
        self._columns: Columns | None = None
        self._rows: list[list[float]] = []
        self._next_picture = self._next_piece = 0.0
        self._next_sample = -np.inf
        self._slowest = 0.0
        self._ticks = self._missed = 0
        self._last: Tick | None = None

    @property
    def columns(self) -> Columns | None:
        """Known from the first tick on."""
        return self._columns

    def show(self, plant: MujocoPlant) -> None:
        """Draws another scene with the same bodies from now on."""
        self._body, self._ghost = Poser(plant.model, self._robot.n), Poser(plant.model, self._robot.n)

    def __call__(self, tick: Tick) -> None:
        if self._columns is None:
            self._columns = Columns.of(tick, self._robot.joint_names)
        self._ticks += 1
        busy = tick.wall.get("plan", 0.0) + tick.wall.get("control", 0.0)
        self._slowest = max(self._slowest, busy)
        self._missed += busy > self.period
        self._last = tick
        now = tick.measurement.time
        if now >= self._next_sample:
            self._rows.append(self._columns.row(tick, self._shared.acting, self._slowest))
            self._next_sample, self._slowest = now + _SAMPLE_PERIOD - 1e-9, 0.0
        self.refresh()

    def refresh(self, *, now: bool = False) -> None:
        """Sends what is due; called while the loop is paused as well."""
        clock = time.monotonic()
        if self._last is None or self._columns is None:
            return
        if now or clock >= self._next_picture:
            self._next_picture = clock + SCENE_PERIOD
            self._send(self._picture(self._last, self._columns))
        if now or clock >= self._next_piece:
            self._next_piece = clock + CURVE_PERIOD
            self._send(self.pulse())
            if self._rows:
                self._send(Samples(self._run, np.array(self._rows)))
                self._rows = []

    def _picture(self, tick: Tick, columns: Columns) -> Picture:
        return picture(self._run, tick, columns, self._body, self._ghost, self._shared.acting, self._shared.offset)

    def pulse(self, ended: str | None = None) -> Pulse:
        """State of the loop. Args: ended: why the run has stopped."""
        paced = self.report()
        at = 0.0 if self._last is None else self._last.measurement.time
        phase = "" if self._last is None else self._last.reference.phase
        playing = paced.playing and ended is None
        factor = paced.real_time_factor if playing else 0.0
        return Pulse(at, playing, factor, self._missed, self._ticks, self.recording(), ended, phase)
