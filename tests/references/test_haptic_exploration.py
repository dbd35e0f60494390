"""The exploration as a source: frames, axes, bounds, bad signals, diagnostics."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest
from pydantic import ValidationError

from pliant.errors import ConfigError, PliantError, SignalError
from pliant.references.exploration.config import ExplorationConfig
from pliant.references.exploration.haptic_exploration import CHANNELS, HapticExploration
from pliant.references.exploration.rules import AxisPhase
from pliant.references.schedule import LatestReference
from pliant.spatial import exp3, log3
from tests.references.explored import PERIOD, estimate, play, reference, task, tuned
from tests.twins.exploration.sliding_span import SlidingSpan


def test_offset_moves_against_the_missing_force_and_is_reported() -> None:
    out, _ = play(HapticExploration(LatestReference(reference(task()))), 50, foot=(3, 0, 10, 0, 0, 0))
    offset = out.diagnostics["exploration/foot/offset"]
    np.testing.assert_allclose(out.tasks[0].position, np.array([0.3, 0.1, 0.0]) + offset)
    assert offset[2] < -1e-3
    assert not offset[:2].any()  # no force desired there
    assert out.diagnostics["exploration/foot/phase"].tolist() == [AxisPhase.OFF, AxisPhase.OFF, AxisPhase.CONTACT]
    assert set(out.diagnostics) == {f"exploration/foot/{name}" for name in CHANNELS}
    assert out.tasks[0].tuning is not None


def test_bound_that_shrinks_holds_in_the_same_tick() -> None:
    box = LatestReference(reference(task()))
    source = HapticExploration(box)
    out, state = play(source, 400, foot=(0, 0, 2, 0, 0, 0))
    assert out.diagnostics["exploration/foot/offset"][2] == -0.02
    assert out.diagnostics["exploration/foot/unreachable"][2] == 1.0
    box.put(reference(task(tuning=tuned(range_=0.005))))
    out, state = source.step(estimate(400, foot=(0, 0, 2, 0, 0, 0)), state)
    assert out.diagnostics["exploration/foot/offset"][2] == -0.005
    out, state = source.step(estimate(401, foot=(0, 0, np.nan, 0, 0, 0)), state)
    assert out.diagnostics["exploration/foot/offset"][2] == -0.005


def test_force_beyond_the_maximum_is_clamped_and_reported() -> None:
    out, _ = play(
        HapticExploration(LatestReference(reference(task(wrench=(0, 0, -160, 0, 0, 0))))), 3, foot=np.zeros(6)
    )
    assert out.tasks[0].wrench[2] == -100.0
    assert out.diagnostics["exploration/foot/clamped"][2] == -60.0


def test_signal_that_is_not_finite_holds_everything() -> None:
    source = HapticExploration(LatestReference(reference(task())))
    before, state = play(source, 30, foot=(0, 0, 10, 0, 0, 0))
    held, state = play(source, 5, 30, state, foot=(0, np.inf, np.nan, 0, 0, 0))
    np.testing.assert_array_equal(held.tasks[0].position, before.tasks[0].position)
    after, _ = play(source, 5, 35, state, foot=(0, 0, 10, 0, 0, 0))
    assert np.isfinite(after.tasks[0].position).all()


def test_frames_are_explored_on_their_own() -> None:
    tasks = task("left"), task("right", wrench=(0, 0, -20, 0, 0, 0)), task("elbow", wrench=np.zeros(6))
    out, _ = play(
        HapticExploration(LatestReference(reference(*tasks))), 40, left=(0, 0, 10, 0, 0, 0), right=(0, 0, -5, 0, 0, 0)
    )
    assert out.diagnostics["exploration/left/offset"][2] < 0.0 < out.diagnostics["exploration/right/offset"][2]
    assert out.tasks[2] is tasks[2]  # nothing to feel


def test_six_axes_turn_the_target_about_the_moment() -> None:
    R = exp3([0.3, -0.2, 0.5])
    wrench = (0, 0, 0, 0, 0.5, 0)
    source = HapticExploration(LatestReference(reference(task(wrench=wrench, tuning=tuned(6), rotation=R))))
    out, _ = play(source, 50, foot=(0, 0, 0, 0, 0.2, 0))
    offset = out.diagnostics["exploration/foot/offset"]
    assert offset.shape == (6,)
    assert offset[4] < -1e-4
    np.testing.assert_allclose(log3(out.tasks[0].rotation @ R.T), offset[3:], atol=1e-12)


def test_no_desired_force_brings_the_offset_back_slowly() -> None:
    box = LatestReference(reference(task()))
    source = HapticExploration(box)
    out, state = play(source, 200, foot=(0, 0, 10, 0, 0, 0))
    start = out.diagnostics["exploration/foot/offset"][2]
    box.put(reference(task(wrench=np.zeros(6))))
    out, state = play(source, 10, 200, state, foot=(0, 0, 10, 0, 0, 0))
    assert out.diagnostics["exploration/foot/offset"][2] == pytest.approx(start + 0.1 * 10 * PERIOD)
    out, state = play(source, 500, 210, state)  # no signal is needed any more
    assert out.diagnostics["exploration/foot/offset"][2] == 0.0


def test_parameters_change_with_the_reference() -> None:
    box = LatestReference(reference(task()))
    source = HapticExploration(box)
    _, state = play(source, 20, foot=(0, 0, 10, 0, 0, 0))
    slow = ExplorationConfig(speed=1e-4)
    box.put(reference(task(), tuning=slow))
    before, state = play(source, 1, 20, state, foot=(0, 0, 10, 0, 0, 0))
    after, state = play(source, 10, 21, state, foot=(0, 0, 10, 0, 0, 0))
    moved = after.tasks[0].position[2] - before.tasks[0].position[2]
    assert abs(moved) <= 1e-4 * 10 * PERIOD * (1 + 1e-9)


def test_frame_that_was_away_starts_anew() -> None:
    box = LatestReference(reference(task()))
    source = HapticExploration(box)
    _, state = play(source, 200, foot=(0, 0, 10, 0, 0, 0))
    box.put(reference())
    _, state = play(source, 200, 200, state)
    box.put(reference(task()))
    out, _ = play(source, 1, 400, state, foot=(0, 0, 10, 0, 0, 0))
    assert abs(out.diagnostics["exploration/foot/offset"][2]) < 1e-3


def test_pause_does_not_make_the_target_jump() -> None:
    source = HapticExploration(LatestReference(reference(task())))
    before, state = play(source, 20, foot=(0, 0, 10, 0, 0, 0))
    after, _ = source.step(estimate(20 + 90, foot=(0, 0, 10, 0, 0, 0)), state)
    assert abs(after.tasks[0].position[2] - before.tasks[0].position[2]) <= 0.15 * 0.02 + 1e-12


def test_span_is_that_of_the_window() -> None:
    random, span = np.random.default_rng(0), SlidingSpan()
    values = random.normal(size=300)
    for index, value in enumerate(values):
        got = span.add(index * PERIOD, float(value), index * PERIOD - 0.0201)
        part = values[max(0, index - 20) : index + 1]
        assert got == pytest.approx(part.max() - part.min())


@pytest.mark.parametrize(
    ("make", "wrenches", "words"),
    [
        (task, {}, "no force signal; there is none"),
        (task, {"fot": np.zeros(6)}, "did you mean 'fot'"),
        (lambda: dataclasses.replace(task(), tuning=None), {"foot": np.zeros(6)}, "needs its impedance"),
        (lambda: task(wrench=(0, 0, np.nan, 0, 0, 0)), {"foot": np.zeros(6)}, "is not finite"),
    ],
)
def test_bad_input_is_named(make, wrenches, words: str) -> None:
    with pytest.raises(PliantError, match=words):
        play(HapticExploration(LatestReference(reference(make()))), 1, **wrenches)


def test_time_that_runs_backwards_is_refused() -> None:
    source = HapticExploration(LatestReference(reference(task())))
    _, state = play(source, 20, foot=np.zeros(6))
    with pytest.raises(SignalError, match="backwards"):
        source.step(estimate(3, foot=np.zeros(6)), state)


def test_config_refuses_impossible_values_and_documents_every_parameter() -> None:
    for values in ({"gain": -1.0}, {"gain": float("nan")}, {"speed": 0.0}, {"mode": "magic"}, {"gian": 1.0}):
        with pytest.raises(ValidationError):
            ExplorationConfig(**values)
    for name, field in ExplorationConfig.model_fields.items():
        assert field.description, name
        if isinstance(field.default, float):
            assert isinstance(field.json_schema_extra, dict), name
            assert "unit" in field.json_schema_extra, name


def test_tunings_of_the_exploration_are_passed_on() -> None:
    bare = dataclasses.replace(task(), tuning=None)
    source = HapticExploration(LatestReference(reference(bare)), tunings={"foot": tuned()})
    out, _ = play(source, 2, foot=np.zeros(6))
    assert out.tasks[0].tuning is source.tunings["foot"]
    with pytest.raises(ConfigError):
        play(HapticExploration(LatestReference(reference(bare))), 1, foot=np.zeros(6))


def test_documentation_names_every_parameter_and_channel() -> None:
    page = (Path(__file__).parents[2] / "docs" / "haptic_exploration.md").read_text()
    for name in ExplorationConfig.model_fields:
        assert name in page or name.endswith("_rotation"), name
    for channel in CHANNELS:
        assert f"`{channel}`" in page, channel
