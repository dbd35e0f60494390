"""Controls made from a typed configuration: unit, range and help on each, and the reason where a value is refused."""

from __future__ import annotations

import math
import threading
import tomllib
from collections.abc import Callable
from typing import Any

import viser

from pliant.errors import PliantError
from pliant.live.link.steering_lock import SteeringLock
from pliant.live.page.basic import apart
from pliant.live.page.fields import FieldGroup, Leaf, Path

WATCHING = ("You are watching", "Another browser steers. Take over on the tab Run.")
Change = Callable[[Path, Any], None]
"""takes a new value at a place; raises PliantError if it may not be"""


class Form:
    """The controls of one group of values.

    Args:
        gui: the page.
        steering: which browser may change values.
        group: what there is to change.
        change: called with every new value.
        expanded: whether folders of the first level are open.
        basic: says of a value that it is basic; the others go into a folder of their own. None: all are.
    """

    def __init__(
        self,
        gui: viser.GuiApi,
        steering: SteeringLock,
        group: FieldGroup,
        change: Change,
        *,
        expanded: bool = True,
        basic: Callable[[Leaf], bool] | None = None,
    ) -> None:
        self._gui, self._steering, self._change = gui, steering, change
        self._lock = threading.RLock()
        self._whole = gui.add_folder(None)
        first, rest = (group, None) if basic is None else apart(group, basic)
        with self._whole:
            self._fill(first, expanded, 0)
            if rest is not None and rest.entries:
                with gui.add_folder("Advanced", expand_by_default=False):
                    self._fill(rest, False, 0)

    def remove(self) -> None:
        """Removes the controls from the page."""
        self._whole.remove()

    def _fill(self, group: FieldGroup, expanded: bool, depth: int) -> None:
        for entry in group.entries:
            if isinstance(entry, Leaf):
                self._add(entry)
            elif any(True for _ in entry.leaves()):
                with self._gui.add_folder(entry.label, expand_by_default=expanded and depth < 2):
                    self._fill(entry, expanded, depth + 1)

    def _add(self, leaf: Leaf) -> None:
        handle = make(self._gui, leaf)
        reason = self._gui.add_markdown("", visible=False)
        good = handle.value

        def changed(event: viser.GuiEvent[Any]) -> None:
            nonlocal good
            with self._lock:
                if handle.value == good:
                    return
                if not self._steering.allows(event.client_id):
                    handle.value = good
                    tell(event, *WATCHING)
                    return
                try:
                    self._change(leaf.path, parsed(leaf, handle.value))
                except PliantError as error:
                    handle.value = good
                    reason.content, reason.visible = refusal(str(error)), True
                    return
                good = handle.value
                if reason.visible:
                    reason.visible = False

        handle.on_update(changed)


def make(gui: viser.GuiApi, leaf: Leaf) -> Any:
    """The control that fits a value."""
    look: dict[str, Any] = {"hint": _hint(leaf)}
    match leaf.kind:
        case "switch":
            return gui.add_checkbox(leaf.label, bool(leaf.value), **look)
        case "choice":
            options = (*leaf.choices, *(("none",) if leaf.optional else ()))
            return gui.add_dropdown(leaf.label, options, initial_value=_text(leaf.value), **look)
        case "vector":
            x, y, z = (float(v) for v in leaf.value)
            return gui.add_vector3(leaf.label, (x, y, z), step=_step(max(abs(v) for v in (x, y, z))), **look)
        case "integer":
            return gui.add_number(leaf.label, int(leaf.value), step=1, **look)
        case "number":
            return _number(gui, leaf, float(leaf.value), look)
        case "text":
            return gui.add_text(leaf.label, _text(leaf.value), **look)


def _number(gui: viser.GuiApi, leaf: Leaf, value: float, look: dict[str, Any]) -> Any:
    if leaf.minimum is None or leaf.maximum is None or leaf.maximum > 1e4 * max(abs(value), 1e-2):
        return gui.add_number(leaf.label, value, step=_step(abs(value)), **look)
    low, high = min(leaf.minimum, value), max(leaf.maximum, value)
    return gui.add_slider(leaf.label, low, high, _step(high - low), value, **look)


def parsed(leaf: Leaf, value: Any) -> Any:
    """The value of the configuration for what the control shows."""
    if leaf.kind == "vector":
        return tuple(float(v) for v in value)
    if leaf.kind in ("text", "choice") and leaf.optional and str(value).strip().lower() in ("none", ""):
        return None
    if leaf.kind == "text" and not isinstance(leaf.value, str):
        try:
            return tomllib.loads(f"value = {value}")["value"]
        except tomllib.TOMLDecodeError:
            return str(value)
    return value


def refusal(reason: str) -> str:
    """The text of a refusal, shown under a control."""
    safe = reason.replace("<", "&lt;").replace("*", "\\*").replace("_", "\\_")
    return f'<span style="color:#c22f2f">Refused: {safe}</span>'


def tell(event: viser.GuiEvent[Any], title: str, body: str) -> None:
    """Shows a notification in the browser that caused an event."""
    if event.client is not None:
        event.client.add_notification(title, body, auto_close_seconds=6.0, color="orange")


def _hint(leaf: Leaf) -> str:
    parts = [leaf.description] if leaf.description else [leaf.path[-1].replace("_", " ")]
    if leaf.unit and leaf.unit != "1":
        parts.append(f"unit {leaf.unit}")
    if leaf.minimum is not None and leaf.maximum is not None:
        parts.append(f"usually {leaf.minimum:g} to {leaf.maximum:g}")
    if leaf.optional:
        parts.append("or none")
    return "; ".join(parts)


def _text(value: Any) -> str:
    if value is None:
        return "none"
    value = getattr(value, "value", value)
    return str(list(value)) if isinstance(value, tuple) else str(value)


def _step(size: float) -> float:
    """A hundredth of a size, rounded down to a power of ten."""
    return 10.0 ** math.floor(math.log10(size) - 2.0) if size > 0.0 else 0.01
