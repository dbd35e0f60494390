"""Several browsers may watch, one steers."""

from __future__ import annotations

import threading

import viser


class SteeringLock:
    """Which browser steers: the first that connects, until it disconnects or another one takes over."""

    def __init__(self, server: viser.ViserServer) -> None:
        self._lock = threading.Lock()
        self._holder: int | None = None
        self._server = server
        server.on_client_connect(self._came)
        server.on_client_disconnect(self._went)

    @property
    def holder(self) -> int | None:
        """Number of the browser that steers; None if none is connected."""
        return self._holder

    @property
    def taken(self) -> bool:
        return self._holder is not None

    def allows(self, client: int | None) -> bool:
        """Whether a browser may change something. The program itself (None) always may."""
        return client is None or self._holder in (None, client)

    def take(self, client: int | None) -> None:
        """Another browser steers from now on."""
        with self._lock:
            self._holder = client

    def watchers(self) -> int:
        """How many browsers watch without steering."""
        return max(0, len(self._server.get_clients()) - self.taken)

    async def _came(self, client: viser.ClientHandle) -> None:
        with self._lock:
            if self._holder is None:
                self._holder = client.client_id

    async def _went(self, client: viser.ClientHandle) -> None:
        with self._lock:
            if self._holder == client.client_id:
                others = [number for number in self._server.get_clients() if number != client.client_id]
                self._holder = min(others, default=None)
