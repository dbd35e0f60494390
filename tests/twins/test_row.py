"""The compiled row of a tick against the values at the paths of its channels, looked up one by one."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from pliant.environment import Environment, EstimatedSurface
from pliant.errors import ShapeError
from pliant.flat_channels import FlatChannels, FlatLayout
from pliant.signals import ImpedanceTuning, Tick
from pliant.spatial import Array
from pliant.telemetry import Recorder
from pliant.telemetry.channels import Key, PlacedChannel
from pliant.telemetry.info import RunInfo
from pliant.telemetry.row_layout import RowLayout
from pliant.telemetry.schema import channels_of
from tests.telemetry.ticks import make_tick

SURFACE = EstimatedSurface(np.arange(3.0), np.arange(3.0, 6.0), np.array([0.0, 0.0, 1.0]), 0.01)


class Own(Mapping[str, Any]):
    """A mapping that is no dict."""

    def __init__(self, values: Mapping[str, Any]) -> None:
        self.values_of = dict(values)

    def __getitem__(self, name: str) -> Any:
        return self.values_of[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self.values_of)

    def __len__(self) -> int:
        return len(self.values_of)


def looked_up(tick: Tick, placed: PlacedChannel) -> Any:
    """The value at a channel's path."""
    value: Any = tick
    for step in placed.path:
        value = getattr(value, step) if isinstance(step, str) else value[step.name if isinstance(step, Key) else step]
    return value


def twin(tick: Tick) -> Array:
    """The row of a tick."""
    found = [np.asarray(looked_up(tick, placed), dtype=float).ravel() for placed in channels_of(tick, RunInfo())]
    return np.concatenate(found)


def filled(layout: RowLayout, tick: Tick) -> Array | None:
    """The compiled row; None: the tick has another one."""
    rows = np.full((2, layout.row.width), np.nan)
    answer = layout.row.fill(tick, rows, 1)
    assert np.isnan(rows[0]).all()
    return rows[1] if answer < 0 else None


def layout_of(tick: Tick) -> RowLayout:
    return RowLayout.of(tick, RunInfo(), ())


def rich(k: int = 0) -> Tick:
    """A tick with what the synthetic ones lack, numbers of other kinds and arrays that do not lie in rows."""
    tick = make_tick(k)
    estimate = replace(
        tick.estimate,
        environments={"tool": Environment(1e4 + k, 10.0, 100.0, np.inf)},
        surfaces={"tool": SURFACE},
        q=np.arange(14.0)[::2] + k,
    )
    odd: Any = {
        "whole": 3,
        "truth": True,
        "small": np.float32(0.1),
        "flag": np.bool_(True),
        "none": np.array(2.5),
        "one": np.array([k]),
        "flags": np.array([True, False]),
        "across": np.asfortranarray(np.arange(6.0).reshape(2, 3) + k),
        "back": np.arange(4.0)[::-1],
        "swapped": np.arange(3.0).astype(">f8"),
    }
    command = replace(tick.command, diagnostics=odd)
    reference = replace(tick.reference, diagnostics=Own({"a": 1.5 + k, "b": np.arange(3.0)}))
    assert tick.truth is not None
    truth = replace(tick.truth, rotations={"tool": np.asfortranarray(tick.truth.rotations["tool"])})
    return replace(tick, estimate=estimate, command=command, reference=reference, truth=truth, guard=k % 3)


@pytest.mark.parametrize("make", [make_tick, rich])
def test_rows_are_those_of_the_paths_bit_for_bit(make: Any) -> None:
    layout = layout_of(make(0))
    for k in range(0, 20, 3):
        row = filled(layout, make(k))
        assert row is not None
        assert row.tobytes() == twin(make(k)).tobytes()
    assert twin(make(0)).tobytes() != twin(make(3)).tobytes()


def test_each_channel_moves_its_own_numbers_alone() -> None:
    """Control: an array that changes in place changes the entries of its channel, and no others."""
    tick = rich()
    layout = layout_of(tick)
    before, at = filled(layout, tick), 0
    assert before is not None
    for placed in channels_of(tick, RunInfo()):
        value = looked_up(tick, placed)
        if isinstance(value, np.ndarray) and value.dtype == float and value.flags.writeable:
            was = value.copy()
            value += 1.0
            after = filled(layout, tick)
            value[...] = was
            assert after is not None
            moved = np.flatnonzero(after != before)
            assert moved.tolist() == list(range(at, at + placed.channel.size)), placed.channel.name
        at += placed.channel.size


def changed(tick: Tick, signal: str, **fields: Any) -> Tick:
    return replace(tick, **{signal: replace(getattr(tick, signal), **fields)})


def variants(tick: Tick) -> dict[str, Tick]:
    """Ticks of other rows than this one's."""
    first, second = tick.reference.tasks
    assert tick.truth is not None
    assert first.tuning is not None
    diagnostics = dict(tick.command.diagnostics)
    tuning = ImpedanceTuning(first.tuning.stiffness, first.tuning.force_max, first.tuning.range)
    return {
        "no truth": replace(tick, truth=None),
        "limit excess": changed(tick, "truth", limit_excess=np.zeros(7)),
        "no disturbance": changed(tick, "estimate", disturbance=None),
        "no posture": changed(tick, "reference", posture=None),
        "no sensor": changed(tick, "measurement", wrenches={}),
        "another sensor": changed(tick, "measurement", wrenches={"foot": np.zeros(6)}),
        "a body more": changed(tick, "truth", objects={**tick.truth.objects, "ball": np.zeros(7)}),
        "surface": changed(tick, "estimate", surfaces={"tool": SURFACE}),
        "fewer tasks": changed(tick, "reference", tasks=(first,)),
        "other order": changed(tick, "reference", tasks=(second, first)),
        "another frame": changed(tick, "reference", tasks=(replace(first, frame="foot"), second)),
        "a rotation": changed(tick, "reference", tasks=(first, replace(second, rotation=np.eye(3)))),
        "no rotation": changed(tick, "reference", tasks=(replace(first, rotation=None), second)),
        "no tuning": changed(tick, "reference", tasks=(replace(first, tuning=None), second)),
        "no linear range": changed(tick, "reference", tasks=(replace(first, tuning=tuning), second)),
        "turned diagnostics": changed(tick, "command", diagnostics=dict(reversed(diagnostics.items()))),
        "no diagnostics": changed(tick, "command", diagnostics={}),
        "longer": changed(tick, "command", diagnostics={**diagnostics, "ee/force": np.zeros(7)}),
        "array for a number": changed(tick, "command", diagnostics={**diagnostics, "ee/energy_stored": np.zeros(1)}),
        "own mapping of other keys": changed(tick, "reference", diagnostics=Own({"other": 1.0})),
    }


@pytest.mark.parametrize("name", variants(make_tick(0)))
def test_a_tick_of_another_structure_does_not_fit_and_has_a_row_of_its_own(name: str) -> None:
    other = variants(make_tick(0))[name]
    assert filled(layout_of(make_tick(0)), other) is None
    row = filled(layout_of(other), other)
    assert row is not None
    assert row.tobytes() == twin(other).tobytes()
    if name != "array for a number":  # a number fits in an array of one
        assert filled(layout_of(other), make_tick(0)) is None


@pytest.mark.parametrize("value", ["1.0", None, 1j, np.zeros(6, complex), np.array(["a"] * 6), [1, 2], object()])
def test_what_is_no_number_does_not_fit(value: Any) -> None:
    tick = make_tick(0)
    for name in ("ee/force", "ee/energy_stored"):
        odd = changed(tick, "command", diagnostics={**tick.command.diagnostics, name: value})
        assert filled(layout_of(tick), odd) is None


def test_a_signal_of_a_wrong_size_is_named() -> None:
    tick = changed(make_tick(0), "measurement", v=np.zeros(5))
    with Recorder(None) as recorder, pytest.raises(ShapeError, match="measurement/v"):
        recorder(tick)


def test_rows_that_are_not_there_are_refused() -> None:
    tick = make_tick(0)
    layout = layout_of(tick)
    for shape, index in (((2, layout.row.width), 2), ((2, layout.row.width + 1), 0)):
        with pytest.raises(ValueError, match="row"):
            layout.row.fill(tick, np.zeros(shape), index)


def test_an_interrupt_in_somebodys_mapping_passes_through() -> None:
    class Stops(Own):
        def __getitem__(self, name: str) -> Any:
            raise KeyboardInterrupt

    tick = make_tick(0)
    with pytest.raises(KeyboardInterrupt):
        layout_of(tick).row.fill(
            changed(tick, "command", diagnostics=Stops(tick.command.diagnostics)),
            np.zeros((1, layout_of(tick).row.width)),
            0,
        )


LAYOUT = FlatLayout({"b": 0, "a": slice(1, 4), "c": 4})  # in a log, channels stand in another order


def flat(layout: FlatLayout, begin: float) -> Tick:
    """A tick whose command's channels count up from a number."""
    numbers = np.arange(begin, begin + layout.size)
    tick = make_tick(0)
    return replace(tick, command=replace(tick.command, diagnostics=FlatChannels(layout, numbers)))


def test_channels_in_one_array_are_those_read_one_by_one() -> None:
    layout = layout_of(flat(LAYOUT, 0.0))
    same_names = FlatLayout(LAYOUT.places)
    for tick in (flat(LAYOUT, 3.0), flat(LAYOUT, 7.0), flat(same_names, 9.0), flat(LAYOUT, -2.0)):
        row = filled(layout, tick)
        assert row is not None
        assert row.tobytes() == twin(tick).tobytes()


def test_other_channels_in_one_array_are_another_row() -> None:
    layout = layout_of(flat(LAYOUT, 0.0))
    assert filled(layout, flat(LAYOUT, 0.0)) is not None  # baseline; from here on the layout is known
    for places in ({"b": 0, "c": slice(1, 4), "a": 4}, {"b": 0, "a": slice(1, 3), "c": 3}, {"b": 0, "a": slice(1, 5)}):
        assert filled(layout, flat(FlatLayout(places), 0.0)) is None
    gaps = FlatLayout({"b": 0, "a": slice(2, 5), "c": 7})
    row = filled(layout, flat(gaps, 1.0))
    assert row is not None
    assert row.tobytes() == twin(flat(gaps, 1.0)).tobytes()
    assert filled(layout, flat(gaps, 2.0)) is not None
    short = flat(LAYOUT, 0.0)
    short = replace(short, command=replace(short.command, diagnostics=FlatChannels(LAYOUT, np.zeros(4))))
    assert filled(layout, short) is None


def test_a_layout_is_in_the_order_of_its_numbers() -> None:
    assert LAYOUT.followed_by(("d", "e")).places == {**LAYOUT.places, "d": 5, "e": 6}
    with pytest.raises(ShapeError, match="'a' begins at 0"):
        FlatLayout({"b": slice(1, 4), "a": 0})
