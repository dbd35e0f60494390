"""Whatever people turn while the robot presses, every axis of the force stays within the bound of that tick."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

from pliant import loop
from pliant.configuration import merged
from pliant.errors import PliantError
from pliant.experiments.base import CaseConfig
from pliant.experiments.registry import get_study
from pliant.live.link.messages import Aim, Flow, Message, Note, Parameters, PushNow
from pliant.live.loop.pace import Pace
from pliant.live.loop.session import Session
from pliant.live.loop.tuning import parameters_of
from pliant.live.page.fields import Leaf, group_of, nested
from pliant.spatial import Array
from pliant.telemetry.log import Log
from pliant.telemetry.recorder import Recorder

CHANGES, BETWEEN = 60, 40  # ticks from one change to the next


def hold_beside_wall() -> CaseConfig:
    study = get_study("stack")
    changes: dict[str, Any] = {
        "path": {"kind": "hold", "ramp": 0.0},
        "duration": 3.0,
        "joints": {"friction": 0.0, "damping": 1.0},
    }
    return merged(study.case("figure8-wall"), changes)


@dataclass
class Steered:
    """A finished run in which many things were changed."""

    log: Log
    accepted: int
    refused: int
    notes: list[Message]


@dataclass
class Hand:
    """What the person at the controls did so far."""

    config: CaseConfig
    ticks: int = 0
    accepted: int = 0
    refused: int = 0


def random_value(rng: np.random.Generator, leaf: Leaf) -> float:
    """Anything within a little more than the range that the control offers."""
    assert leaf.minimum is not None
    assert leaf.maximum is not None
    span = leaf.maximum - leaf.minimum
    return float(rng.uniform(leaf.minimum - 0.05 * span, leaf.maximum))


@pytest.fixture(scope="module")
def steered() -> Steered:
    """A run with 60 random changes of gains, bounds and ranges, with pushes and another target between them."""
    rng = np.random.default_rng(7)
    study, config = get_study("stack"), hold_beside_wall()
    notes: list[Message] = []
    session = Session(study, config, notes.append, 1)
    hand = Hand(config)
    parameters = parameters_of(config)
    assert parameters is not None
    leaves = [leaf for leaf in group_of(parameters).leaves() if leaf.maximum is not None and leaf.minimum is not None]
    leaves = [leaf for leaf in leaves if leaf.path[0] == "tasks"]

    def turn() -> None:
        hand.ticks += 1
        if hand.ticks % BETWEEN:
            return
        leaf = leaves[int(rng.integers(len(leaves)))]
        try:
            hand.config = merged(hand.config, nested(("control", *leaf.path), random_value(rng, leaf)))
        except PliantError:
            hand.refused += 1
            return
        hand.accepted += 1
        session.obey(Parameters(hand.config), pace)
        session.obey(Aim((0.3 * float(rng.uniform()), 0.0, 0.05 * float(rng.standard_normal()))), pace)
        session.obey(PushNow("elbow", (20.0, 0.0, 20.0), 0.02), pace)

    pace = Pace(session.plant.period, turn, lambda seconds: None, paced=False)
    pace.flow = Flow()
    wired = session.experiment
    with Recorder(None) as recorder:
        ticks = pace(range(CHANGES * BETWEEN))
        outcome = loop.run(wired.plant, wired.estimator, wired.source, wired.controller, ticks, [recorder])
        assert outcome.failure is None
    return Steered(recorder.log(), hand.accepted, hand.refused, notes)


def force_and_bound(log: Log, label: str, frame: str) -> tuple[Array, Array]:
    """|h| (k, axes) of a task and the bound at the same ticks, from the first change on."""
    force, time = np.abs(log[f"{label}/force"]), log.time(f"{label}/force")
    bound, changed = log[f"reference/{frame}/force_max"], log.time(f"reference/{frame}/force_max")
    return force[np.searchsorted(time, changed)], bound


@pytest.mark.parametrize(("label", "frame"), [("ee", "flange"), ("elbow", "elbow")])
def test_no_change_breaks_a_bound(steered: Steered, label: str, frame: str) -> None:
    force, bound = force_and_bound(steered.log, label, frame)
    assert np.all(force <= bound * (1.0 + 1e-12))


def test_the_bounds_were_reached_and_moved(steered: Steered) -> None:
    """Baseline: the changes arrived and mattered, so that the law above could have been broken."""
    assert steered.accepted >= 15
    assert steered.refused >= 5
    force, bound = force_and_bound(steered.log, "ee", "flange")
    assert len(np.unique(bound, axis=0)) >= 4
    assert float(np.max(force[:, 0] / bound[:, 0])) > 0.95
    largest = float(force[:, 0].max())
    assert np.any(bound[:, 0] < 0.9 * largest), "the bound never fell below a force that was reached"


def test_torques_stay_finite_and_within_limits(steered: Steered) -> None:
    torque = steered.log["command/torque"]
    assert np.isfinite(torque).all()
    limit = get_study("stack").build(hold_beside_wall()).robot.torque_limit
    assert np.all(np.abs(torque) <= limit + 1e-9)
    assert not [note for note in steered.notes if isinstance(note, Note)]
