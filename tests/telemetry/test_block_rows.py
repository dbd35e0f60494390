"""Rows of a block of ticks: where views stand in them, and how a recorder copies them."""

from __future__ import annotations

import io
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from pliant.compiled import Rows, place_of
from pliant.signals import Command, Estimate, Measurement, Reference, Tick
from pliant.spatial import Array
from pliant.telemetry.info import RunInfo
from pliant.telemetry.recorder import Recorder
from pliant.telemetry.row_layout import RowLayout


def test_place_of_a_view() -> None:
    row = np.zeros(12)
    assert place_of(row[3:7], row) == 3
    assert place_of(row[3:12].reshape(3, 3), row) == 3
    assert place_of(row[3:12:2], row) is None
    assert place_of(np.zeros(3), row) is None
    assert place_of(row[3:7], row[:5]) is None


@pytest.mark.parametrize("known", [True, False])
def test_numbers_that_are_no_copies_are_recorded_one_by_one(known: bool) -> None:
    """Of a block whose ticks hold what is computed from its numbers, every row comes from a tick in Python."""
    zero, factor = np.zeros(7), 1.0 if known else 2.0
    estimate, reference = Estimate(0.0, zero, zero, zero, zero), Reference(0.0)
    first = Tick(Measurement(0.0, zero, zero, zero, zero), estimate, reference, Command(0.0, zero, zero), None)

    def tick(row: Array) -> Tick:
        estimate = replace(first.estimate, q=factor * row[1:8])
        return replace(first, measurement=replace(first.measurement, time=row.item(0), q=row[1:8]), estimate=estimate)

    numbers = np.random.default_rng(1).normal(size=(5, 8))
    rows = [recorded(tick, numbers, block) for block in (True, False)]
    assert rows[0] == rows[1]
    copied = RowLayout.of(tick(numbers[0]), RunInfo(), ()).copied(tick, 8)
    assert (copied is not None) is known


def recorded(tick: Callable[[Array], Tick], numbers: Array, block: bool) -> bytes:
    stream = io.BytesIO()
    with Recorder(stream) as recorder:
        if block:
            recorder.take_block(Rows(numbers, tick, {}))
        else:
            for row in numbers:
                recorder(tick(row))
    return stream.getvalue()
