"""Blocks of ticks without Python: the same log, byte by byte, as the loop in Python, and when they are not used."""

from __future__ import annotations

import gc
import weakref
from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from pliant import blocks
from pliant.compiled import KnownReferences
from pliant.experiments.registry import get_study
from pliant.references.postures.posture_source import PostureSource
from pliant.references.source import Started
from pliant.signals import Estimate, Reference
from pliant.simulation import MujocoPlant, Push
from pliant.spatial import Array
from pliant.wiring.experiment import Experiment
from tests.both_loops import Counts, both, run

STUDY = get_study("stack")


@cache
def wired(case: str = "figure8-plain") -> Experiment:
    return STUDY.build(STUDY.case(case))


def with_plant(experiment: Experiment, **changes: Any) -> Experiment:
    """The same robot built with other arguments."""
    plant = experiment.plant
    assert isinstance(plant, MujocoPlant)
    given: dict[str, Any] = {"period": plant.period, "start": plant.start, "joints": plant.joints, "observe": ["elbow"]}
    return replace(experiment, plant=MujocoPlant(plant.robot, plant.scene, **given | changes))


@pytest.mark.parametrize("case", ["figure8-plain", "figure8-hardware", "figure8-wall", "singular"])
def test_a_block_gives_the_log_of_the_loop_in_python(case: str) -> None:
    _, counts = both(wired(case), 700)
    assert counts.single < 3


def test_a_comparison_of_logs_can_fail() -> None:
    """Baseline: one unit in the last place of the start is another log."""
    start = np.array(wired().source.start)  # type: ignore[attr-defined]
    start[0] = np.nextafter(start[0], 1.0)
    moved = with_plant(wired(), start=start)
    assert run(moved, 300, python=False)[0] != run(with_plant(wired()), 300, python=False)[0]


def test_pushes_begin_and_end_within_a_block() -> None:
    push = Push("elbow", (30.0, -20.0, 10.0), 0.0503, 0.1)
    pushed = with_plant(wired(), pushes=[push])
    _, counts = both(pushed, 300)
    assert counts.single < 3
    assert run(pushed, 300, python=False)[0] != run(with_plant(wired()), 300, python=False)[0]


def test_a_change_of_tuning_is_for_python() -> None:
    experiment = wired("calibration")
    changes = [change.time for change in experiment.source.changes]  # type: ignore[attr-defined]
    ticks = round(changes[6] / experiment.plant.period)
    _, counts = both(experiment, ticks)
    assert 2 < counts.single < 0.2 * ticks


@pytest.mark.parametrize("most", [1, 2, 7, 255])
def test_odd_lengths_of_blocks(most: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(blocks, "MOST", most)
    _, counts = both(wired(), 531)
    assert max(counts.blocks) == most


@pytest.mark.parametrize("ticks", [0, 1, 2, 257, 258, 513])
def test_a_run_ends_at_any_place_of_a_block(ticks: int) -> None:
    assert both(wired(), ticks)[0].ticks == ticks


@pytest.mark.parametrize("decimation", [2, 3, 300])
def test_a_recorder_that_leaves_ticks_out(decimation: int) -> None:
    both(wired(), 700, decimation)


@pytest.mark.parametrize(("limit", "force"), [(0.03, 0.0), (2.0, 2000.0)])
def test_a_robot_that_stops_in_the_middle(limit: float, force: float) -> None:
    push = [Push("elbow", (force, 0.0, 0.0), 0.2, 0.2)] if force else []
    outcome, counts = both(with_plant(wired(), speed_stop=limit, pushes=push), 3000)
    assert outcome.failure is not None
    assert "times its speed limit" in outcome.failure
    assert 1 < outcome.ticks < 2900
    assert counts.single < 3


def test_a_robot_that_stops_leaves_no_cycle_of_objects() -> None:
    """Which would keep its log until the next search for cycles."""
    experiment, counts = with_plant(wired(), speed_stop=0.03), Counts()
    gone = weakref.ref(counts)
    gc.disable()
    try:
        outcome = experiment.run(range(3000), [counts])
        blocks_were = len(counts.blocks)
        del counts
        assert outcome.failure is not None
        assert blocks_were
        assert gone() is None
    finally:
        gc.enable()


def test_a_simulation_that_diverges() -> None:
    push = Push("elbow", (1e12, 0.0, 0.0), 0.1, 1.0)
    outcome, counts = both(with_plant(wired(), pushes=[push]), 400)
    assert outcome.failure is not None
    assert outcome.ticks < 400
    assert sum(counts.blocks) > 50


# ---------------------------------------------------------------------- unusual ticks


class Torn(PostureSource):
    """Postures whose references are spoiled at some times, in both loops."""

    def __init__(self, inner: PostureSource, spoiled: Sequence[float]) -> None:
        self.inner, self.spoiled = inner, spoiled

    def init(self, estimate: Estimate) -> Started:
        return self.inner.init(estimate)

    def step(self, estimate: Estimate, state: Started) -> tuple[Reference, Started]:
        reference, state = self.inner.step(estimate, state)
        if estimate.time in self.spoiled:
            reference.tasks[0].position[1] = np.nan
        return reference, state

    def compiled_face(self, estimate: Estimate, state: Started) -> Any:
        return TornReferences(self.inner.compiled_face(estimate, state), self.spoiled)


class TornReferences(KnownReferences):
    def __init__(self, inner: KnownReferences, spoiled: Sequence[float]) -> None:
        self.inner, self.size, self.spoiled = inner, inner.size, spoiled

    def reference(self, time: float, numbers: Array) -> Reference:
        return self.inner.reference(time, numbers)

    def fill(self, times: Array, rows: Array) -> int:
        count = self.inner.fill(times, rows)
        rows[np.isin(times, self.spoiled), 1] = np.nan
        return count


def test_a_fault_in_a_block_is_found_by_the_guard_in_python() -> None:
    """Spoiled references within blocks, several in a row among them; the last ones end the run."""
    period = wired().plant.period
    spoiled = [k * period for k in (40, 41, 42, 300, *range(600, 700))]
    source = wired().source
    assert isinstance(source, PostureSource)
    outcome, counts = both(replace(wired(), source=Torn(source, spoiled)), 700)
    assert outcome.failure is not None
    assert "no sound signal came for 50 ms" in outcome.failure
    assert 600 < outcome.ticks < 700
    assert sum(counts.blocks) > 300
