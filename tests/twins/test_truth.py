"""The compiled truth of a simulated world against the same numbers read in Python."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest

from pliant import _plant
from pliant.simulation.mujoco_library import can_look_inside
from pliant.simulation.truth import TruthReader
from pliant.simulation.world import World

MODEL = mujoco.MjModel.from_xml_string(
    """<mujoco><worldbody><body><joint name="a" type="hinge" axis="0 0 1"/><geom size="0.1"/><site name="one"/>
    <body pos="0.3 0 0"><joint name="b" type="slide" axis="1 0 0"/><geom size="0.1"/><site name="two" pos="0 0 0.1"/>
    </body></body><body name="ball" pos="0 0 1"><freejoint/><geom size="0.1"/></body>
    <body name="box" pos="1 0 1"><freejoint/><geom type="box" size="0.1 0.1 0.1"/></body></worldbody></mujoco>"""
)
LOWER, UPPER = np.array([-0.5, -np.inf]), np.array([0.5, np.inf])
SITES = {"two": MODEL.site("two").id, "one": MODEL.site("one").id}
BODIES = {"box": MODEL.body("box").id, "ball": MODEL.body("ball").id}


def moved(seed: int) -> mujoco.MjData:
    data, rng = mujoco.MjData(MODEL), np.random.default_rng(seed)
    data.qvel[:] = rng.standard_normal(MODEL.nv)
    data.qpos[:2] = rng.standard_normal(2)
    data.qfrc_applied[:] = rng.standard_normal(MODEL.nv)
    mujoco.mj_step(MODEL, data)
    return data


@pytest.mark.parametrize("bodies", [BODIES, {}])
def test_both_are_the_same_bit_for_bit(bodies: dict[str, int]) -> None:
    assert can_look_inside()
    reader = TruthReader(MODEL, LOWER, UPPER, SITES, bodies)
    beyond: list[float] = []
    for seed in range(20):
        data = moved(seed)
        assert reader.row(data).tobytes() == reader.in_python(data).tobytes()
        assert reader.row(data).tobytes() != reader.row(moved(seed + 1)).tobytes()
        beyond.append(reader.row(data)[6])
    assert 0 < np.count_nonzero(beyond) < 20  # within the limits and beyond them


def test_a_position_that_is_not_a_number_stays_so() -> None:
    data = moved(0)
    data.qpos[0] = np.nan
    reader = TruthReader(MODEL, LOWER, UPPER, SITES, BODIES)
    assert np.isnan(reader.row(data)[[0, 6]]).all()
    assert reader.row(data)[7] == 0.0


def test_each_number_has_its_name() -> None:
    data = moved(1)
    world = World(data, 3, {"two": np.ones(6)}, frozenset(), np.zeros(2))
    truth = TruthReader(MODEL, LOWER, UPPER, SITES, BODIES).truth(world, 0.25)
    assert truth.time == 0.25
    assert np.array_equal(truth.q, data.qpos[:2])
    assert np.array_equal(truth.v, data.qvel[:2])
    assert np.array_equal(truth.torque, data.qfrc_applied[:2])
    assert [*truth.positions] == [*truth.rotations] == ["two", "one"]
    for name in SITES:
        assert np.array_equal(truth.positions[name], data.site(name).xpos)
        assert np.array_equal(truth.rotations[name].ravel(), data.site(name).xmat)
    for name in BODIES:
        assert np.array_equal(truth.objects[name], np.concatenate([data.body(name).xpos, data.body(name).xquat]))
    before = truth.q.copy()
    mujoco.mj_step(MODEL, data)
    assert np.array_equal(truth.q, before)  # a copy


def test_values_of_another_model_are_refused() -> None:
    good = (LOWER.tolist(), UPPER.tolist(), [0], [1])
    row = _plant.TruthRow(MODEL, *good)
    with pytest.raises(ValueError, match="out must have 27 entries"):
        row.read(moved(0), np.empty(26))
    with pytest.raises(ValueError, match="two limits"):
        _plant.TruthRow(MODEL, [0.0], [], [], [])
    for sites, bodies in (([2], []), ([-1], []), ([], [5])):
        with pytest.raises(ValueError, match="does not have these"):
            _plant.TruthRow(MODEL, [0.0], [0.0], sites, bodies)
