"""The web server of the page: viser behind a check of the token."""

from __future__ import annotations

from types import TracebackType
from typing import Self

from pliant.live.server.access import AccessControl, is_loopback, listen, new_token
from pliant.live.server.protected import protected_viser, silent

_BRAND = (11, 111, 184)
_MESSAGES_UNDER_PANELS = "<style>.mantine-Notifications-root { z-index: 3 !important }</style>"
"""messages lie over the scene, and under panels that reach there: panels have the z-index 5"""


class PageServer:
    """An empty page at an address.

    Args:
        host, port: where browsers connect; port 0 takes any free one.

    Raises:
        ConfigError: the address cannot be listened at.
    """

    def __init__(self, host: str, port: int) -> None:
        listening = listen(host, port)
        self.port = int(listening.getsockname()[1])
        access = AccessControl(host, self.port, new_token())
        try:
            self.viser = protected_viser(access, listening)
        except BaseException:
            listening.close()
            raise
        shown = f"[{host}]" if ":" in host else host
        self.url = f"http://{shown}:{self.port}/?token={access.token}"
        """link that opens the page"""
        self.exposed = not is_loopback(host)
        """whether other machines can reach the page"""
        gui = self.viser.gui
        gui.configure_theme(show_logo=False, show_share_button=False, brand_color=_BRAND, control_width="medium")
        gui.main_panel.dock_right()
        gui.main_panel.set_width(356)
        gui.add_html(_MESSAGES_UNDER_PANELS)

    def stop(self) -> None:
        """Closes the page."""
        with silent():
            self.viser.stop()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.stop()
