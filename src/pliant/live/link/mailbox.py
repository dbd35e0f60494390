"""A queue between two threads that has a bounded size and never makes the sender wait."""

from __future__ import annotations

import threading
from collections import deque

from pliant.live.link.messages import Message, Queued

_KEPT = 256  # queued messages; a reader that is further behind than that loses the oldest


class Mailbox:
    """Keeps the latest message of each kind, and those that are `Queued` in their order."""

    def __init__(self) -> None:
        self._latest: dict[type[Message], Message] = {}
        self._queued: deque[Message] = deque(maxlen=_KEPT)
        self._filled = threading.Condition()
        self.waiting = False
        """whether there is a message; reading it takes no lock"""

    def put(self, message: Message) -> None:
        """Adds a message. A newer one of the same kind replaces it."""
        with self._filled:
            if isinstance(message, Queued):
                self._queued.append(message)
            else:
                self._latest[type(message)] = message
            self.waiting = True
            self._filled.notify()

    def take(self) -> list[Message]:
        """All messages: first the queued ones in their order, then the latest of each other kind."""
        with self._filled:
            found = [*self._queued, *self._latest.values()]
            self._queued.clear()
            self._latest.clear()
            self.waiting = False
        return found

    def wait(self, seconds: float) -> bool:
        """Waits for a message. Returns whether there is one."""
        with self._filled:
            return self._filled.wait_for(lambda: self.waiting, seconds)
