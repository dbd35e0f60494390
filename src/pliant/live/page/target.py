"""Moving the target: a handle in the scene that follows the reference until a user drags it."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any

import numpy as np
import viser

from pliant.live.link.messages import Aim, Message, Picture
from pliant.live.link.steering_lock import SteeringLock
from pliant.live.page.form import WATCHING, tell
from pliant.spatial import Array


class TargetControls:
    """The handle, and the factor on the force. Args: server: the page. steering: which browser may drag.
    send: takes a message for the loop.
    """

    def __init__(self, server: viser.ViserServer, steering: SteeringLock, send: Callable[[Message], None]) -> None:
        self._steering, self._send = steering, send
        self._aim = Aim()
        self._nominal: Array = np.zeros(3)
        self._dragging = False
        self._lock = threading.RLock()  # assigning to a control calls back at once
        gui = server.gui
        self._offset = gui.add_vector3(
            "offset [m]",
            (0.0, 0.0, 0.0),
            step=0.005,
            hint="Offset from the task's own target, world axes; or drag the handle.",
        )
        self._force = gui.add_slider(
            "F_d factor [%]", 0.0, 200.0, 5.0, 100.0, hint="Factor on the desired force of the task.", visible=False
        )
        home = gui.add_button("Back to the task's target", icon=viser.Icon.HOME)
        self._handle = server.scene.add_transform_controls("/target", 0.18, disable_rotations=True, visible=False)
        self._offset.on_update(self._typed)
        self._force.on_update(self._typed)
        home.on_click(self._home)
        self._handle.on_update(self._drag)

    @property
    def handle(self) -> viser.TransformControlsHandle:
        """The handle that users drag."""
        return self._handle

    def reset(self) -> None:
        """The task's own target."""
        with self._lock:
            self._aim = Aim()
            self._offset.value, self._force.value = (0.0, 0.0, 0.0), 100.0

    def follow(self, picture: Picture, presses: bool) -> None:
        """Moves the handle along with the reference. Args: presses: whether the task has a desired force."""
        with self._lock:
            self._handle.visible = picture.nominal is not None
            if self._force.visible != presses:
                self._force.visible = presses
            if picture.nominal is None:
                return
            self._nominal = picture.nominal
            if not self._dragging:
                self._handle.position = self._nominal + np.array(self._aim.offset)

    def _drag(self, event: viser.TransformControlsEvent) -> None:
        if not self._steering.allows(event.client_id):
            return
        with self._lock:
            self._dragging = event.phase != "end"
            x, y, z = (round(float(part), 4) for part in np.array(self._handle.position) - self._nominal)
            self._aim = Aim((x, y, z), self._aim.force_scale)
            self._offset.value = self._aim.offset
            self._send(self._aim)

    def _typed(self, event: viser.GuiEvent[Any]) -> None:
        with self._lock:
            x, y, z = self._offset.value
            aim = Aim((float(x), float(y), float(z)), self._force.value / 100.0)
            if aim == self._aim:
                return
            if not self._steering.allows(event.client_id):
                self._offset.value, self._force.value = self._aim.offset, 100.0 * self._aim.force_scale
                tell(event, *WATCHING)
                return
            self._aim = aim
            self._send(aim)

    def _home(self, event: viser.GuiEvent[Any]) -> None:
        if not self._steering.allows(event.client_id):
            return
        self.reset()
        self._send(Aim())
