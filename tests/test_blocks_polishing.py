"""Blocks of ticks of the polishing study: imperfect robots, phases, previews and predictive controllers."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from pliant import blocks
from pliant.compiled import KnownReferences
from pliant.experiments.registry import get_study
from pliant.frozen import changed
from pliant.interfaces import ReferenceSource
from pliant.references.known_phases import KnownPhase
from pliant.references.phase_state import PhaseState
from pliant.references.phases import PhasedSource
from pliant.references.retuned import Retuned
from pliant.signals import Estimate, Reference, Tick
from pliant.simulation.imperfections.draws import Draws
from pliant.spatial import Array
from pliant.wiring.experiment import Experiment
from tests.both_loops import both, run

STUDY = get_study("polishing")
CASES = [
    ("tables-2-3-4-delayed", "offset-free-mpc"),
    ("tables-2-3-4-delayed", "force-feedback-mpc"),
    ("sensor-mismatch", "torque-feedback-mpc"),
    ("fast-pushed", "force-feedback-mpc"),
]


@cache
def wired(case: str = "tables-2-3-4-delayed", controller: str = "offset-free-mpc") -> Experiment:
    return STUDY.build(STUDY.case(case).model_copy(update={"controller": controller}))


@pytest.mark.parametrize(("case", "controller"), CASES)
def test_a_block_gives_the_log_of_the_loop_in_python(case: str, controller: str) -> None:
    """Over the first contact: the environment becomes known, phases change, and one robot stops."""
    outcome, counts = both(wired(case, controller), 1700)
    assert sum(counts.blocks) > 0.95 * outcome.ticks


def test_a_preview_goes_through_a_source_that_retunes() -> None:
    case = wired("ideal", "force-feedback-mpc")
    _, counts = both(replace(case, source=Retuned(case.source, [])), 400)
    assert counts.blocks


@pytest.mark.parametrize("most", [1, 3, 100])
def test_odd_lengths_of_blocks(most: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(blocks, "MOST", most)
    both(wired(), 700)


def test_another_seed_is_another_log() -> None:
    """Baseline: a comparison of logs can fail."""
    other = STUDY.build(STUDY.case("tables-2-3-4-delayed").model_copy(update={"seed": 1}))
    assert run(other, 60, python=False)[0] != run(wired(), 60, python=False)[0]


def test_a_torque_beyond_a_limit_is_cut_off_in_python() -> None:
    """The guard knows a lower limit than the controller: the controller's state goes back to the tick in question."""
    ticks: list[Tick] = []
    wired().run(range(900), [ticks.append])
    most = np.max([np.abs(tick.command.torque) for tick in ticks[100:]], axis=0)
    robot = wired().robot
    lower: Any = SimpleNamespace(model=robot.model, n=robot.n, torque_limit=0.98 * most, joint_names=robot.joint_names)
    outcome, counts = both(replace(wired(), robot=lower), 900)
    assert outcome.failure is None
    assert counts.single > 10
    assert len(counts.blocks) > 3


# ---------------------------------------------------------------------- a refusal


class Pulls(ReferenceSource[PhaseState]):
    """A task that asks the surface to pull, from a time on."""

    def __init__(self, inner: PhasedSource, since: float) -> None:
        self.inner, self.since = inner, since

    def init(self, estimate: Estimate) -> PhaseState:
        return self.inner.init(estimate)

    def step(self, estimate: Estimate, state: PhaseState) -> tuple[Reference, PhaseState]:
        reference, state = self.inner.step(estimate, state)
        preview = reference.preview
        if preview is not None and estimate.time >= self.since:
            reference = changed(reference, preview=changed(preview, wrench=preview.wrench - 60.0))
        return reference, state

    def compiled_face(self, estimate: Estimate, state: PhaseState) -> KnownReferences | None:
        if self.inner.compiled_face(estimate, state) is None:
            return None
        sample, _ = self.step(estimate, changed(state, next_look=-np.inf))
        names = [phase.name for phase in self.inner.phases]
        phase = self.inner.phases[state.index]
        until = state.start + phase.duration - 1e-9
        return KnownPhase(sample, names, lambda time, at: self.step(changed(estimate, time=time), at), state, until)


def test_a_refusal_of_the_controller_ends_the_run_as_in_python() -> None:
    source = wired().source
    assert isinstance(source, PhasedSource)
    outcome, counts = both(replace(wired(), source=Pulls(source, 0.1501)), 600)
    assert outcome.failure is not None
    assert 140 < outcome.ticks < 160
    assert sum(counts.blocks) > 100


@pytest.mark.parametrize("once", [1, 3, 4])
def test_draws_ahead_are_those_that_are_taken(once: int) -> None:
    widths, noisy = {"a": 3, "b": 2}, {"a": True, "b": True}
    plain, ahead = (Draws.start(3, widths, noisy, once) for _ in range(2))
    found: list[Array] = []
    for wanted, used in ((30, 10), (200, 200), (1, 0), (7, 7), (100, 3)):
        found.append(ahead.ahead(wanted * once)[: used * once].copy())
        ahead.pass_by(used * once)
        found.append(ahead.take(once).copy())
    rows = np.concatenate(found)
    np.testing.assert_array_equal(rows, np.concatenate([plain.take(once).copy() for _ in range(len(rows) // once)]))
