"""The web server of the page: viser on the loopback interface, behind the gate."""

from __future__ import annotations

import contextlib
import io
from types import TracebackType
from typing import Any, Self

import viser

from pliant.live.server.access import Gate, is_loopback, new_token

_BRAND = (11, 111, 184)


class PageServer:
    """An empty page at an address.

    Args:
        host, port: where browsers connect; port 0 takes any free one.

    Raises:
        ConfigError: the address cannot be listened at.
    """

    def __init__(self, host: str, port: int) -> None:
        token = "" if is_loopback(host) else new_token()
        with _silent():
            self.viser = viser.ViserServer("127.0.0.1", 0, label="pliant", verbose=False)
        try:
            self._gate = Gate(host, port, self.viser.get_port(), token)
        except BaseException:
            self._stop_viser()
            raise
        self.port = self._gate.port
        shown = f"[{host}]" if ":" in host else host
        self.url = f"http://{shown}:{self.port}/" + (f"?token={token}" if token else "")
        """link that opens the page"""
        self.guarded = bool(token)
        gui = self.viser.gui
        gui.configure_theme(show_logo=False, show_share_button=False, brand_color=_BRAND, control_width="medium")
        gui.main_panel.dock_right()
        gui.main_panel.set_width(356)

    def stop(self) -> None:
        """Takes the page away."""
        self._gate.stop()
        self._stop_viser()

    def _stop_viser(self) -> None:
        with _silent():
            self.viser.stop()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.stop()


def _silent() -> contextlib.AbstractContextManager[Any]:
    """viser announces an address of its own, which is not the one to open."""
    return contextlib.redirect_stdout(io.StringIO())
