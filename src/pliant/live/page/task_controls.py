"""Force, speed and path of the task that runs, on the first tab."""

from __future__ import annotations

import math
import threading
from collections.abc import Callable
from typing import Any

import viser

from pliant.experiments.base_config import Dial
from pliant.live.link.messages import Message, TaskScaling
from pliant.live.link.steering_lock import SteeringLock
from pliant.live.page.form import WATCHING, tell

_SLOWEST = 0.1
"""share of the task's speed; at zero the task would not end"""
_STEPS = 200  # of a slider, at least


class TaskControls:
    """A slider for force and for speed, in the task's own units, up to its limits. It scales the running task by a
    factor.

    Args:
        server: the page.
        steering: which browser may move them.
        send: takes a message for the loop.
    """

    def __init__(self, server: viser.ViserServer, steering: SteeringLock, send: Callable[[Message], None]) -> None:
        self._gui, self._steering, self._send = server.gui, steering, send
        self._lock = threading.RLock()  # assigning to a control calls back at once
        self.folder = server.gui.add_folder("Task", visible=False)
        """where they stand; the path's controls are beside them"""
        self._dials: tuple[Dial, ...] = ()
        self._sliders: dict[str, viser.GuiSliderHandle[float]] = {}
        self._scaling = TaskScaling()

    def offer(self, dials: tuple[Dial, ...]) -> None:
        """Sliders for what can be changed in a running task, at the task's own values."""
        with self._lock:
            self._scaling = TaskScaling()
            for slider in self._sliders.values():
                slider.remove()
            self._dials, self._sliders = dials, {}
            self.folder.visible = bool(dials)
            with self.folder:
                for dial in dials:
                    self._sliders[dial.name] = self._slider(dial)

    def _slider(self, dial: Dial) -> viser.GuiSliderHandle[float]:
        low = _SLOWEST * dial.value if dial.name == "speed" else 0.0
        step = 10.0 ** math.floor(math.log10(dial.high / _STEPS))
        what = (
            "Largest force of the task; other forces keep their ratio to it."
            if dial.name == "force"
            else ("Speed along the path on the surface.")
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
            wanted = TaskScaling(**{dial.name: self._sliders[dial.name].value / dial.value for dial in self._dials})
            if wanted == self._scaling:
                return
            if not self._steering.allows(event.client_id):
                for dial in self._dials:
                    self._sliders[dial.name].value = getattr(self._scaling, dial.name) * dial.value
                tell(event, *WATCHING)
                return
            self._scaling = wanted
            self._send(wanted)
