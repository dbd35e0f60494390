"""Small windows: the curves fold away, so that scene and controls have room."""

from __future__ import annotations

import viser

WIDE = 1100
"""px; in a window that is narrower the curves begin folded into a strip at the left edge"""
_SHEET = 576  # px; up to it viser shows one sheet at the bottom, in which panels begin folded


class NarrowWindows:
    """Folds a panel in each browser that opens the page in a narrow window; a click unfolds it.

    The size is that of the window, since a browser reports it before it has heard of any panel. One that comes back
    after its connection broke reports what its panels leave of the window.

    Args:
        server: the page.
        panel: that folds, at the left edge.
    """

    def __init__(self, server: viser.ViserServer, panel: viser.PanelHandle) -> None:
        self._panel = panel
        server.on_client_connect(self._came)

    async def _came(self, client: viser.ClientHandle) -> None:
        if _SHEET < client.camera.image_width < WIDE:
            # One browser's handle of a panel that all browsers have: viser offers that for its main panel alone.
            here = client.gui.main_panel
            here._placement_uuid = self._panel._placement_uuid  # pyright: ignore[reportPrivateUsage]
            here.minimize()
