"""Pushing the robot: by a button, or by dragging an arrow."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import viser

from pliant.live.link.messages import Message, Picture, Pull, PushNow
from pliant.live.link.steering_lock import SteeringLock
from pliant.live.page.form import WATCHING, tell
from pliant.spatial import Array

_DIRECTIONS: Mapping[str, tuple[float, float, float]] = {
    "+x": (1, 0, 0), "−x": (-1, 0, 0), "+y": (0, 1, 0), "−y": (0, -1, 0), "+z": (0, 0, 1), "−z": (0, 0, -1),
}  # fmt: skip
_NO_FRAMES: tuple[str, ...] = ("–",)
_NEWTONS_PER_METRE = 250.0  # of a dragged arrow
_RENEWED = 0.1  # s between two renewals of a dragged force


class PushControls:
    """Controls of pushes, and the arrow to drag.

    Args:
        server: the page.
        steering: which browser may push.
        send: takes a message for the loop.
    """

    def __init__(self, server: viser.ViserServer, steering: SteeringLock, send: Callable[[Message], None]) -> None:
        self._steering, self._send = steering, send
        gui = server.gui
        self._frame = gui.add_dropdown("frame", _NO_FRAMES, hint="Frame of the robot that is pushed.")
        self._force = gui.add_slider("force [N]", 1.0, 200.0, 1.0, 30.0, hint="Force of the push.")
        self._direction = gui.add_dropdown(
            "direction", tuple(_DIRECTIONS), hint="Direction of the push, an axis of the world."
        )
        self._duration = gui.add_slider("duration [s]", 0.05, 2.0, 0.05, 0.3, hint="Duration of the push.")
        button = gui.add_button("Push", icon=viser.Icon.HAND_FINGER, hint="Applies the push once.")
        self._by_hand = gui.add_checkbox(
            "drag an arrow", False, hint=f"Shows a handle at the frame: drag it, {_NEWTONS_PER_METRE:g} N per metre."
        )
        self._handle = server.scene.add_transform_controls("/push", 0.22, disable_rotations=True, visible=False)
        self._held: Array | None = None
        self._at = np.zeros(3)
        self._renewed = 0.0
        self._lock = threading.RLock()
        button.on_click(self._push)
        self._by_hand.on_update(lambda _: self._show())
        self._handle.on_update(self._drag)

    def offer(self, frames: Sequence[str], chosen: str) -> None:
        """Frames that can be pushed, and the one to begin with."""
        if tuple(frames) != tuple(self._frame.options):
            self._frame.options = tuple(frames)
            self._frame.value = chosen if chosen in frames else frames[-1]

    @property
    def frame(self) -> str:
        return self._frame.value

    def follow(self, picture: Picture, at: Array | None) -> None:
        """Keeps the arrow at its frame, and renews the force while a user drags it. Args: at: (3,) m of the frame."""
        with self._lock:
            self._at = picture.tool if at is None else at
            if self._held is None:
                self._handle.position = self._at
                return
            if time.monotonic() - self._renewed > _RENEWED and self._steering.taken:
                self._pull()

    def _show(self) -> None:
        self._handle.visible = self._by_hand.value

    def _push(self, event: viser.GuiEvent[Any]) -> None:
        if not self._steering.allows(event.client_id):
            tell(event, *WATCHING)
            return
        x, y, z = (self._force.value * part for part in _DIRECTIONS[self._direction.value])
        self._send(PushNow(self.frame, (x, y, z), self._duration.value))

    def _drag(self, event: viser.TransformControlsEvent) -> None:
        if not self._steering.allows(event.client_id):
            return
        with self._lock:
            self._held = None if event.phase == "end" else np.array(self._handle.position)
            self._pull()

    def _pull(self) -> None:
        self._renewed = time.monotonic()
        force = np.zeros(3) if self._held is None else _NEWTONS_PER_METRE * (self._held - self._at)
        x, y, z = (float(part) for part in force)
        self._send(Pull(self.frame, (x, y, z)))
