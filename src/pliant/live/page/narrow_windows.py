"""Small windows: the curves fold away, so that scene and controls have room."""

from __future__ import annotations

import asyncio

import viser

WIDE = 1100
"""px; in a window that is narrower the curves begin folded into a strip at the left edge"""
_PANELS = 714  # px that curves and controls take from the scene
_PERIOD, _LOOKS = 0.2, 150  # s between two looks, and how many: a browser may draw its panels late


class NarrowWindows:
    """Folds a panel in each browser that opens the page in a narrow window; a click unfolds it.

    What a browser reports is the width of the scene, before or after its panels were drawn; a scene that they leave
    less than `WIDE` - 714 px stands in a narrow window. Below 576 px viser shows one sheet, where panels begin folded.

    Args:
        server: the page.
        panel: that folds, at the left edge.
    """

    def __init__(self, server: viser.ViserServer, panel: viser.PanelHandle) -> None:
        self._server, self._panel = server, panel
        server.on_client_connect(self._came)

    async def _came(self, client: viser.ClientHandle) -> None:
        for _ in range(_LOOKS):
            if client.camera.image_width < WIDE - _PANELS:
                # One browser's handle of a panel that all browsers have: viser offers that for its main panel alone.
                here = client.gui.main_panel
                here._placement_uuid = self._panel._placement_uuid  # pyright: ignore[reportPrivateUsage]
                here.minimize()
                return
            await asyncio.sleep(_PERIOD)
            if client.client_id not in self._server.get_clients():
                return
