"""Every study can be steered while it runs: the desired force and the parameters reach whoever uses them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pytest

from pliant import loop
from pliant.configuration import merged
from pliant.experiments.registry import get_study, study_names
from pliant.live.link.messages import Aim, Message, Note, Parameters, Ready
from pliant.live.loop.pace import Pace
from pliant.live.loop.session import Session
from pliant.live.loop.steered_source import TARGET_SPEED
from pliant.live.loop.tuning import online_fields, online_group, parameters_of
from pliant.signals import Tick


def steer(
    study_name: str, case: str, ticks: int, at: int, asks: Sequence[Any], changes: Mapping[str, Any] | None = None
) -> tuple[list[Tick], list[Message]]:
    """Runs a changed case and does what is asked at a tick. Each entry is a message, or changes of the case."""
    study = get_study(study_name)
    config = merged(study.case(case), {**(changes or {}), "duration": 1e-3 * ticks})
    said: list[Message] = []
    seen: list[Tick] = []
    session = Session(study, config, said.append, 1)

    def attend() -> None:
        session.announce()
        if len(seen) == at:
            for ask in asks:
                session.obey(Parameters(merged(config, ask)) if isinstance(ask, dict) else ask, pace)

    pace = Pace(session.plant.period, attend, lambda seconds: None, paced=False)
    wired = session.experiment
    watchers = [seen.append, session.watch]
    outcome = loop.run(wired.plant, wired.estimator, wired.source, wired.controller, pace(range(ticks)), watchers)
    assert outcome.failure is None
    return seen, said


@pytest.mark.parametrize(
    ("study", "case", "frame", "force", "change"),
    [
        ("haptic", "floor", "foot", 40.0, {"impedance": {"force_max": (100.0, 100.0, 200.0)}}),
        ("polishing", "ideal", "tool", 50.0, {"control": {"contact": {"stiffness": [4000.0]}}}),
    ],
)
def test_half_the_force_with_other_parameters(study: str, case: str, frame: str, force: float, change: Any) -> None:
    """F_d halved and a parameter changed between two ticks: the contact force follows."""
    half = [Aim((0.0, 0.0, 0.0), 0.5), change]
    ticks, said = steer(study, case, 3000, 2400, half)
    before, after = (tick.truth.wrenches[frame][2] for tick in (ticks[2390], ticks[-1]) if tick.truth is not None)
    assert before == pytest.approx(force, rel=0.03)
    assert after == pytest.approx(0.5 * force, rel=0.05)
    assert not [note for note in said if isinstance(note, Note)]
    assert any(isinstance(message, Ready) for message in said)


def test_the_haptic_impedance_is_swapped_whole() -> None:
    ticks, _ = steer("haptic", "floor", 600, 300, [{"impedance": {"force_max": (100.0, 100.0, 200.0)}}])
    bounds = [
        tick.reference.tasks[0].tuning.force_max[2] for tick in ticks if tick.reference.tasks[0].tuning is not None
    ]
    assert set(bounds) == {300.0, 200.0}
    assert bounds.index(200.0) == 300


def test_a_moved_target_travels_at_a_bounded_speed() -> None:
    """A target that jumped would put energy into the robot that no ledger books."""
    ticks, _ = steer("polishing", "ideal", 400, 100, [Aim((0.05, 0.0, 0.0))])
    plain, _ = steer("polishing", "ideal", 400, 100, [])
    moved = np.array(
        [a.reference.tasks[0].position - b.reference.tasks[0].position for a, b in zip(ticks, plain, strict=True)]
    )
    speed = np.abs(np.diff(moved[:, 0])) / 1e-3
    assert speed.max() <= TARGET_SPEED * (1.0 + 1e-6)
    assert moved[-1, 0] == pytest.approx(0.05)
    rate = np.array(
        [a.reference.tasks[0].velocity[0] - b.reference.tasks[0].velocity[0] for a, b in zip(ticks, plain, strict=True)]
    )
    np.testing.assert_allclose(rate[1:], np.diff(moved[:, 0]) / 1e-3, atol=1e-6)


def test_every_study_offers_something_to_turn() -> None:
    for name in set(study_names()) - {"toy"}:  # tests/studies/toy.py puts itself among them
        for config in (case.config for case in get_study(name).cases.values()):
            assert parameters_of(config) is not None or online_fields(config), f"{name} {config.case}"


def test_a_task_file_is_steered_like_a_study() -> None:
    """The loop of the page runs a task by its name; asked for half the force, half of it is asked for."""

    case = get_study("press").case("press")
    assert parameters_of(case) is None  # of a task the page turns none
    assert online_group(case).entries == ()

    def asked(asks: Sequence[Any]) -> float:
        seen, said = steer("press", "press", 2400, 2300, asks)
        assert any(isinstance(message, Ready) for message in said)
        return float(np.linalg.norm(seen[-1].reference.tasks[0].wrench[:3]))

    assert asked([Aim((0.0, 0.0, 0.0), 0.5)]) == pytest.approx(0.5 * asked([]), rel=1e-6)
