"""Force and speed of the task that runs, on the first tab."""

from __future__ import annotations

import math
import threading
from collections.abc import Callable
from typing import Any

import viser

from pliant.experiments.base_config import Dial
from pliant.live.link.messages import Message, Turned
from pliant.live.link.steering_lock import Seat
from pliant.live.page.form import tell
from pliant.live.page.run_controls import WATCHING

_SLOWEST = 0.1
"""share of the task's speed: a task that stands still would never end"""
_STEPS = 200  # of a slider, at least


class TaskControls:
    """A slider for each dial, in the task's own unit, up to its limits. It turns the running task by a factor.

    Args:
        server: the page.
        seat: who may turn them.
        send: takes a message for the loop.
    """

    def __init__(self, server: viser.ViserServer, seat: Seat, send: Callable[[Message], None]) -> None:
        self._gui, self._seat, self._send = server.gui, seat, send
        self._lock = threading.RLock()  # assigning to a control calls back at once
        self._folder = server.gui.add_folder("Task", visible=False)
        self._dials: tuple[Dial, ...] = ()
        self._sliders: dict[str, viser.GuiSliderHandle[float]] = {}
        self._turned = Turned()

    def offer(self, dials: tuple[Dial, ...]) -> None:
        """Sliders for what a task lets people turn, where the task wants them."""
        with self._lock:
            self._turned = Turned()
            for slider in self._sliders.values():
                slider.remove()
            self._dials, self._sliders = dials, {}
            self._folder.visible = bool(dials)
            with self._folder:
                for dial in dials:
                    self._sliders[dial.name] = self._slider(dial)

    def _slider(self, dial: Dial) -> viser.GuiSliderHandle[float]:
        low = _SLOWEST * dial.value if dial.name == "speed" else 0.0
        step = 10.0 ** math.floor(math.log10(dial.high / _STEPS))
        what = (
            "Largest force of the task; the others keep their ratio to it."
            if dial.name == "force"
            else ("Of the path on the surface.")
        )
        slider = self._gui.add_slider(
            f"{dial.name} [{dial.unit}]",
            low,
            dial.high,
            step,
            min(dial.value, dial.high),
            hint=f"{what} The task asks for {dial.value:g} {dial.unit}; up to {dial.high:g} {dial.unit}.",
        )
        slider.on_update(self._turn)
        return slider

    def _turn(self, event: viser.GuiEvent[Any]) -> None:
        with self._lock:
            wanted = Turned(**{dial.name: self._sliders[dial.name].value / dial.value for dial in self._dials})
            if wanted == self._turned:
                return
            if not self._seat.allows(event.client_id):
                for dial in self._dials:
                    self._sliders[dial.name].value = getattr(self._turned, dial.name) * dial.value
                tell(event, *WATCHING)
                return
            self._turned = wanted
            self._send(wanted)
