"""Two ends of a pipe between the process of the loop and that of the page."""

from __future__ import annotations

import threading
from multiprocessing.connection import Connection

from pliant.live.link.mailbox import Mailbox
from pliant.live.link.messages import Message

_LOOK = 0.2  # s between two looks at whether the link was closed


class Link:
    """Sends and receives messages; neither ever waits for the other side.

    Two threads move messages between the pipe and two mailboxes. If the other side is slow, messages of the same kind
    replace each other in the box; if it is gone, they are dropped and `closed` is set.
    """

    def __init__(self, connection: Connection) -> None:
        self._connection = connection
        self._incoming, self._outgoing = Mailbox(), Mailbox()
        self.closed = threading.Event()
        """set when the other side is gone"""
        self._threads = [
            threading.Thread(target=work, name=f"pliant-live-{name}", daemon=True)
            for name, work in (("receive", self._receive), ("send", self._send))
        ]
        for thread in self._threads:
            thread.start()

    def send(self, message: Message) -> None:
        """Sends a message to the other side without waiting."""
        self._outgoing.put(message)

    @property
    def waiting(self) -> bool:
        """Whether a message has arrived."""
        return self._incoming.waiting

    def take(self) -> list[Message]:
        """The messages since the last call."""
        return self._incoming.take()

    def wait(self, seconds: float) -> bool:
        """Waits for a message. Returns whether one has arrived."""
        return self._incoming.wait(seconds)

    def close(self) -> None:
        """Closes the connection after the last messages have been sent."""
        for _ in range(50):
            if not self._outgoing.waiting or self.closed.wait(0.01):
                break
        self.closed.set()
        for thread in self._threads:
            thread.join(2.0)
        self._connection.close()

    def _receive(self) -> None:
        try:
            while not self.closed.is_set():
                if self._connection.poll(_LOOK):
                    self._incoming.put(self._connection.recv())
        except (EOFError, OSError):
            pass
        finally:
            self.closed.set()

    def _send(self) -> None:
        try:
            while not self.closed.is_set():
                if self._outgoing.wait(_LOOK):
                    for message in self._outgoing.take():
                        self._connection.send(message)
        except OSError:
            self.closed.set()
