"""Records a run: an observer that copies each tick into columns and writes them in a thread of its own."""

from __future__ import annotations

import atexit
import contextlib
import io
import queue
import threading
from collections import deque
from collections.abc import Sequence
from pathlib import Path
from types import TracebackType
from typing import BinaryIO, Self

import numpy as np

from pliant.compiled import Rows
from pliant.errors import ConfigError, OutputError, ShapeError
from pliant.signals import Tick
from pliant.telemetry.channels import Channel
from pliant.telemetry.info import RunInfo
from pliant.telemetry.log import CLOCK, Log
from pliant.telemetry.mcap.topics import PREFIX, units_of
from pliant.telemetry.mcap.writer import McapFile
from pliant.telemetry.row_layout import Block, RowLayout
from pliant.telemetry.scene_topics import DrawnScene, SceneTopics
from pliant.telemetry.target import open_target, whole_seconds_below
from pliant.telemetry.timing import Timing

_BLOCK = 512  # ticks per block: what a killed process loses at most, and one chunk of the file
_KNOWN = 16  # latest layouts that are kept
_WAITING = 4  # full blocks in memory before the loop waits for the file


class Recorder:
    """An observer that writes every tick to an MCAP file. Use it in a `with` block, or call `close`.

    In the loop it only copies numbers into preallocated rows; a thread beside it writes full blocks. However the run
    ends, `close` leaves a readable file with all ticks; a killed process leaves one that is readable up to its last
    full block. The bytes of the file depend on the ticks alone. Wall times go to `NAME.timing.json` beside it.
    """

    def __init__(
        self,
        target: Path | str | BinaryIO | None,
        info: RunInfo | None = None,
        *,
        channels: Sequence[Channel] = (),
        decimation: int = 1,
        scene: DrawnScene | None = None,
        kept: bool = False,
    ) -> None:
        """Opens the file.

        Args:
            target: file to write, a stream, or None to keep the log in memory (`log()` reads it).
            info: what the log says about the run.
            channels: units of diagnostics; a name may be a pattern, the first that fits counts.
            decimation: records every so many ticks, beginning with the first.
            scene: adds frames and shapes for 3-D views, at 30 Hz and beside the loop; None: without.
            kept: keeps a log of up to 64 MB in memory, too, so that `log` need not read the file.

        Raises:
            OutputError: the file cannot be opened.
            ConfigError: decimation is below 1, or the configuration in `info` is not plain data.
        """
        if decimation < 1:
            raise ConfigError(f"decimation must be 1 (every tick) or more, got {decimation}")
        self.info = info or RunInfo()
        metadata = {**self.info.as_metadata(), "decimation": str(decimation)}
        self.path = Path(target) if isinstance(target, (str, Path)) else None
        self._stream, self._owned = open_target(target)
        self._channels, self._decimation = tuple(channels), decimation
        self._layouts: deque[RowLayout] = deque(maxlen=_KNOWN)
        self._block: Block | None = None
        self._seen = 0
        self.timing = Timing()
        self._units: dict[str, str] = {}
        self._file = McapFile(self._stream, kept)
        self._scene = None if scene is None else SceneTopics(scene, self._file)
        self._file.add_metadata("pliant", metadata)
        self._phase = ""
        self._zero: int | None = None
        """ns of the file's clock at which that of the run is zero; None: nothing is written yet"""
        self._error: BaseException | None = None
        self._closed = False
        self._queue: queue.Queue[Block | None] = queue.Queue(maxsize=_WAITING)
        self._thread = threading.Thread(target=self._work, name="pliant-recorder", daemon=True)
        self._thread.start()
        atexit.register(self.close)

    def __call__(self, tick: Tick) -> None:
        """Records one tick.

        Raises:
            OutputError: the file could not be written (the disk is full, say).
            ConfigError: two channels have the same name.
            ShapeError: a diagnostic is neither a number nor an array, or a signal has an array of a wrong size.
        """
        if tick.wall:
            self.timing.add(tick.wall)
        self._seen += 1
        if (self._seen - 1) % self._decimation == 0:
            self._record(tick)

    def take_block(self, rows: Rows) -> None:
        """Records ticks of a block; errors as of a single one."""
        kept = rows.numbers[-self._seen % self._decimation :: self._decimation]
        self._seen += len(rows.numbers)
        self.timing.add_block(rows.wall)
        while len(kept):
            block = self._record(rows.tick(kept[0]))
            kept = kept[1 + block.add_rows(kept[1:], rows.tick) :]

    def _record(self, tick: Tick) -> Block:
        if self._error is not None:
            raise self._failure(self._error)
        block = self._block
        return block if block is not None and block.add(tick) else self._begin_block(tick)

    def log(self) -> Log:
        """Closes the recorder and reads what it wrote.

        Raises:
            OutputError: the file cannot be read, or the target was a stream of the caller.
        """
        self.close()
        if (contents := self._file.contents()) is not None:
            return Log("the log's stream" if self.path is None else str(self.path), contents)
        if self.path is not None:
            return Log.open(self.path)
        if not isinstance(self._stream, io.BytesIO):
            raise OutputError(
                "a log that went into a stream cannot be read back by its recorder; open it with Log.open"
            )
        return Log.open(io.BytesIO(self._stream.getvalue()))

    def close(self, failure: str | None = None) -> None:
        """Writes what is still in memory and finishes the file. A second call does nothing.

        Args:
            failure: why the run ended early, for the log.

        Raises:
            OutputError: the file could not be written.
        """
        if self._closed:
            return
        self._closed = True
        atexit.unregister(self.close)
        self._send()
        self._queue.put(None)
        self._thread.join()
        try:
            if self._error is None:
                self._finish(failure)
        except OSError as error:
            self._error = error
        finally:
            if self._owned:
                with contextlib.suppress(OSError):
                    self._stream.close()
        if self._error is not None:
            raise self._failure(self._error)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        failure = None
        if kind is not None:
            failure = "interrupted" if issubclass(kind, KeyboardInterrupt) else f"{kind.__name__}: {error}"
        try:
            self.close(failure)
        except OutputError:
            if kind is None:
                raise  # the error that ended the run is more important than this one

    # ------------------------------------------------------------------ in the loop

    def _begin_block(self, tick: Tick) -> Block:
        """A block whose first row is this tick."""
        self._send()
        known = (Block(layout, tick.reference.phase, _BLOCK) for layout in self._layouts)
        self._block = next((block for block in known if block.add(tick)), None) or self._new_layout(tick)
        return self._block

    def _new_layout(self, tick: Tick) -> Block:
        layout = self._layout(tick)
        block = Block(layout, tick.reference.phase, _BLOCK)
        if not block.add(tick):
            misfit = layout.misfit(layout.row.fill(tick, block.rows, 0))
            raise ShapeError(f"a tick cannot be recorded: {misfit} has another size than such a signal must have")
        self._layouts.appendleft(layout)
        return block

    def _send(self) -> None:
        if self._block is not None and self._block.count and self._error is None:
            self._queue.put(self._block)
        self._block = None

    def _layout(self, tick: Tick) -> RowLayout:
        layout = RowLayout.of(tick, self.info, self._channels)
        self._units.update(units_of(layout.topics))
        return layout

    # ------------------------------------------------------------------ beside the loop

    def _work(self) -> None:
        while (block := self._queue.get()) is not None:
            if self._error is None:
                try:
                    self._write(block)
                except BaseException as error:
                    self._error = error

    def _write(self, block: Block) -> None:
        times = np.rint(block.times[: block.count] * 1e9).astype(np.int64)
        if self._zero is None:
            self._zero = whole_seconds_below(int(times.min()))
            if self._zero:
                self._file.add_metadata(CLOCK, {"zero_ns": str(self._zero)})
        times = np.maximum(times + self._zero, 0)
        if block.phase != self._phase:
            self._phase = block.phase
            self._file.add_text(f"{PREFIX}/reference/phase", int(times[0]), block.phase)
        columns = block.columns()
        self._file.add_block(block.layout.topics, times, columns)
        if self._scene is not None:
            self._scene.add(times, columns)

    def _finish(self, failure: str | None) -> None:
        if self._scene is not None:
            self._scene.finish()
        self._file.add_metadata("pliant.units", dict(sorted(self._units.items())))
        self._file.add_metadata("pliant.outcome", {"ticks": str(self._seen), "failure": failure or ""})
        self._file.finish()
        if self.path is not None:
            self.timing.write(self.path.with_suffix(".timing.json"))

    def _failure(self, error: BaseException) -> OutputError:
        where = self.path or "the log's stream"
        why = (error.strerror or str(error)) if isinstance(error, OSError) else f"{type(error).__name__}: {error}"
        failure = OutputError(f"{where} cannot be written: {why}")
        failure.__cause__ = error
        return failure
