"""Events that the seed of a run draws: when, which of several, how much."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from pliant.errors import ConfigError
from pliant.experiments.drawn_events import changes_drawn, scaled, tunings_drawn
from pliant.signals import ImpedanceTuning
from pliant.tasks.draws import LogUniform
from pliant.tasks.events import Event

TUNING = ImpedanceTuning(*(np.array(x) for x in ([100.0, 200.0], [9.0, 30.0], [0.3, 0.2], [0.05, 0.1])))


def test_a_change_comes_again_until_the_run_ends_or_it_was_often_enough() -> None:
    again = Event(time=1.0, every=0.25, change={"range": 0.02})
    assert [time for time, _ in changes_drawn(1, again, 0, 2.0)] == [1.0, 1.25, 1.5, 1.75]  # none at the end itself
    assert len(changes_drawn(1, again.model_copy(update={"count": 3}), 0, 2.0)) == 3
    assert changes_drawn(1, again, 0, 1.0) == []
    assert [time for time, _ in changes_drawn(1, Event(time=1.0, change={"range": 0.02}), 0, 2.0)] == [1.0]


def test_one_of_several_is_picked_as_often_as_the_others_and_its_numbers_are_drawn_anew() -> None:
    change = {
        "wrench": [0.0, {"uniform": [-5, 5]}, {"log_uniform": [1, 100]}],
        "range": {"normal": [0.02, 0.001]},
        "reset": {"choice": [False, True]},
    }
    event = Event(every=1.0, count=900, pick="one", change=change)
    found = [one for _, one in changes_drawn(1, event, 3, 1e4)]
    assert all(len(one) == 1 for one in found)
    counts = {name: sum(name in one for one in found) for name in change}
    assert all(250 < count < 350 for count in counts.values())
    wrenches = np.array([one["wrench"] for one in found if "wrench" in one])
    assert np.all(wrenches[:, 0] == 0.0)
    assert np.all(np.abs(wrenches[:, 1]) <= 5.0)
    assert 0.4 < np.mean(wrenches[:, 2] < 10.0) < 0.6  # as often in each decade; of a uniform one a tenth
    assert {one["reset"] for one in found if "reset" in one} == {False, True}
    assert found == [one for _, one in changes_drawn(1, event, 3, 1e4)]
    assert found != [one for _, one in changes_drawn(1, event, 4, 1e4)]
    every = changes_drawn(1, event.model_copy(update={"pick": "all"}), 3, 1e4)
    assert all(set(one) == set(change) for _, one in every)


def test_factors_are_of_the_start_and_keep_an_impedance_possible() -> None:
    """F_max is at least K_0 x_0 and x_0 at most 0.95 x_b, whatever is drawn."""
    event = Event(
        every=1.0,
        count=200,
        factor={name: LogUniform(log_uniform=(0.1, 10.0)) for name in ("stiffness", "force_max", "range")},
    )
    found = tunings_drawn([event], {"flange": TUNING, "elbow": TUNING}, 0, 1e3)
    assert len(found) == 400
    stiffness = np.array([one.tuning.stiffness for one in found])
    assert stiffness.min() >= 10.0
    assert stiffness.max() <= 2000.0  # of the start; of the last one it would wander off
    for one in found:
        bend = one.tuning.linear_range
        assert bend is not None
        assert np.all(one.tuning.force_max >= one.tuning.stiffness * bend * (1.0 - 1e-12))
        assert np.all(bend <= 0.95 * one.tuning.range + 1e-12)
    with pytest.raises(ConfigError, match="this controller has none"):
        tunings_drawn([event], {}, 0, 1e3)


def test_a_scaled_impedance() -> None:
    made = scaled(TUNING, {"stiffness": np.array([2.0, 0.5])})
    np.testing.assert_allclose(made.stiffness, [200.0, 100.0])
    np.testing.assert_allclose(made.force_max, [10.0, 30.0])  # 200 N/m times 0.05 m, not the 9 N of before
    np.testing.assert_allclose(made.range, TUNING.range)
    short = scaled(TUNING, {"range": np.array([0.1, 1.0])})
    np.testing.assert_allclose(short.linear_range, [0.95 * 0.03, 0.1])


def test_targets_come_from_a_file(tmp_path: Path) -> None:
    file = tmp_path / "hand.csv"
    file.write_text("time,x,y,z\n0.0,0.1,0.0,0.2\n0.5,0.2,0.0,0.3\n", encoding="utf-8")
    event = Event(time=1.0, file=str(file))
    assert changes_drawn(1, event, 0, 9.0) == [(1.0, {"target": [0.1, 0.0, 0.2]}), (1.5, {"target": [0.2, 0.0, 0.3]})]
    file.write_text("x,y,z\n0.1,0.0,0.2\n0.2,0.0,0.3\n", encoding="utf-8")
    with pytest.raises(ConfigError, match="needs a column `time`"):
        changes_drawn(1, event, 0, 9.0)
