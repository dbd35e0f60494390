"""A recorder that users switch on and off while the loop runs."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from pliant.errors import OutputError, PliantError
from pliant.signals import Tick
from pliant.telemetry.channels import Channel
from pliant.telemetry.info import RunInfo
from pliant.telemetry.recorder import Recorder
from pliant.telemetry.scene_topics import DrawnScene


class SwitchedRecorder:
    """An observer that records between `start` and `stop`.

    Args:
        info: identity of the run, for each log.
        channels: units of diagnostics.
    """

    def __init__(self, info: RunInfo, channels: Sequence[Channel]) -> None:
        self._info, self._channels = info, tuple(channels)
        self._recorder: Recorder | None = None

    @property
    def path(self) -> Path | None:
        """File to which the recorder writes."""
        return None if self._recorder is None else self._recorder.path

    def start(self, path: Path, info: RunInfo, scene: DrawnScene | None = None) -> None:
        """Begins a log. One that was being written is finished first. Raises OutputError.

        Args: scene: what 3-D views show; a scene that changes while it is recorded stays as it was there.
        """
        self.stop()
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise OutputError(f"the folder {path.parent} cannot be created: {error.strerror}") from error
        self._recorder = Recorder(path, info, channels=self._channels, scene=scene)

    def stop(self, failure: str | None = None) -> Path | None:
        """Finishes the log. Returns its file; None if there was none. Raises OutputError if it could not be written."""
        recorder, self._recorder = self._recorder, None
        if recorder is None:
            return None
        recorder.close(failure)
        return recorder.path

    def __call__(self, tick: Tick) -> None:
        if self._recorder is None:
            return
        try:
            self._recorder(tick)
        except PliantError as error:  # a full disk must not stop the robot
            recorder, self._recorder = self._recorder, None
            self.trouble = str(error)
            try:
                recorder.close(str(error))
            except OutputError:
                return

    trouble: str = ""
    """why the last log ended by itself; the caller that reports it clears it"""
