"""Error of force or path as colour along the way of the tool on the surface."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
import viser

from pliant.live.page.task_error import TaskError
from pliant.simulation import Part, Plane
from pliant.spatial import Array

_KINDS = ("force error", "path error", "none")
_NEXT = 2e-3  # m between two points
_APART = 0.05  # m; farther apart the tool was lifted in between
_KEPT = 3000  # points
_OVER = 1.5e-3  # m above the surface
_GAMMA = 2.2
_EVERY = 9  # pictures between two drawings
_STEPS = (1.0, 2.0, 5.0)
_FINEST = 0.1  # N, mm: a smaller error is no news
_SHARE = 95.0  # % of the points whose error the scale covers
_SIGNED = np.array([[11, 111, 184], [70, 150, 200], [110, 116, 122], [225, 130, 50], [194, 47, 47]], dtype=np.float64)
_SIZES = np.array([[20, 143, 107], [170, 205, 110], [240, 200, 60], [230, 120, 40], [194, 47, 47]], dtype=np.float64)


class _Spot(NamedTuple):
    place: Array
    """(3,) m on the surface"""
    force: float
    """N"""
    path: float
    """mm"""


class ErrorTrail:
    """The coloured way, a choice of what it shows, and its scale.

    Args:
        server: the page.
    """

    def __init__(self, server: viser.ViserServer) -> None:
        self._spots: deque[_Spot] = deque(maxlen=_KEPT)
        self._count = 0
        self._fresh = False
        self._scene = server.scene
        self._kind = server.gui.add_dropdown(
            "colour on surface", _KINDS, hint="Of the way of the tool: how far force or path are off.", visible=False
        )
        self._scale = server.gui.add_html("", visible=False)
        self.controls = (self._kind, self._scale)
        self._handle: Any = None
        self._kind.on_update(lambda _: self._draw())

    @property
    def errors(self) -> Array:
        """(k, 2) N and mm of the points that are kept."""
        return np.array([(spot.force, spot.path) for spot in self._spots]).reshape(-1, 2)

    def forget(self) -> None:
        """Begins anew."""
        self._spots.clear()
        self._fresh = True

    def follow(self, error: TaskError | None, faces: Sequence[Plane | Part]) -> None:
        """Adds what is off now. Args: error: None where nothing is pressed. faces: surfaces of the scene."""
        self._count += 1
        if error is not None:
            self._add(_Spot(_on_surface(error.place, faces), error.force, error.path))
        if self._fresh and self._count % _EVERY == 0:
            self._draw()

    def _add(self, spot: _Spot) -> None:
        if self._spots and np.linalg.norm(spot.place - self._spots[-1].place) < _NEXT:
            here = self._spots.pop()
            spot = _Spot(here.place, spot.force, spot.path)
        self._spots.append(spot)
        self._fresh = True

    def _draw(self) -> None:
        self._fresh = False
        kind, some = self._kind.value, len(self._spots) > 1
        shown = some and kind != "none"
        self._kind.visible, self._scale.visible = some or self._kind.visible, shown
        if self._handle is not None:
            self._handle.visible = shown
        if not shown:
            return
        values, unit, signed = (
            (self.errors[:, 0], "N", True) if kind == "force error" else (self.errors[:, 1], "mm", False)
        )
        top = nice_top(values)
        colours = coloured(values, top, signed=signed)
        places = np.array([spot.place for spot in self._spots])
        joined = np.linalg.norm(np.diff(places, axis=0), axis=1) < _APART
        points = np.stack([places[:-1], places[1:]], axis=1)[joined].astype(np.float32)
        light = (255.0 * (colours / 255.0) ** _GAMMA).astype(np.uint8)  # browsers take colours of corners as light
        pairs = np.stack([light[:-1], light[1:]], axis=1)[joined]
        self._scale.content = scale_of(top, unit, signed=signed)
        if not len(points):
            return
        if self._handle is not None:
            self._handle.remove()
        self._handle = self._scene.add_line_segments("/error_trail", points, pairs, thickness=0.008)


def nice_top(values: Array) -> float:
    """End of a scale: 1, 2 or 5 times a power of ten, from 0.1 on, that covers the size of most values."""
    size = max(float(np.percentile(np.abs(values), _SHARE)), _FINEST)
    power = 10.0 ** np.floor(np.log10(size))
    return next((step * power for step in _STEPS if step * power >= size * (1.0 - 1e-9)), 10.0 * power)


def coloured(values: Array, top: float, *, signed: bool) -> npt.NDArray[np.uint8]:
    """(k, 3) colours, 0 to 255. Args: top: value of the last colour; signed: whether −top is that of the first."""
    table = _SIGNED if signed else _SIZES
    share = 0.5 + 0.5 * values / top if signed else values / top
    at = np.clip(share, 0.0, 1.0) * (len(table) - 1)
    channels = [np.interp(at, np.arange(len(table)), channel) for channel in table.T]
    return np.stack(channels, axis=1).astype(np.uint8)


def scale_of(top: float, unit: str, *, signed: bool) -> str:
    """The colours with the values at their ends, as HTML."""
    table = _SIGNED if signed else _SIZES
    stops = ", ".join(f"rgb({r:.0f} {g:.0f} {b:.0f})" for r, g, b in table)
    low = f"−{top:g}" if signed else "0"
    return (
        '<div style="display:flex;align-items:center;gap:6px;font-size:0.8em;padding:2px 12px 6px">'
        f'<span>{low}</span><span style="flex:1;height:10px;background:linear-gradient(90deg, {stops})"></span>'
        f"<span>{top:g} {unit}</span></div>"
    )


def _on_surface(place: Array, faces: Sequence[Plane | Part]) -> Array:
    """(3,) m, a little above the place of the nearest surface; without one the place itself."""
    if not faces:
        return place
    near = min((face.geometry.near(place) for face in faces), key=lambda one: abs(one.distance))
    return near.point + _OVER * near.normal
