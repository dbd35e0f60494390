"""The exploration along an estimated normal: friction, the cone it stays in, the bound of each axis."""

from __future__ import annotations

import math

import numpy as np
import pytest

from pliant.references.exploration.config import ExplorationConfig
from pliant.references.exploration.haptic_exploration import HapticExploration
from pliant.references.schedule import LatestReference
from tests.references.explored import PERIOD, estimate, play, reference, task
from tests.twins.exploration.contact_normal import angle_between, turned_normal, within_cone


def slide(direction: str, friction: float, tilt: float) -> np.ndarray:
    """Offset after sliding along a tilted plane that pushes back 10 N along its normal, with friction."""
    normal = np.array([-math.sin(tilt), 0.0, math.cos(tilt)])
    along = np.array([math.cos(tilt), 0.0, math.sin(tilt)])
    velocity = np.concatenate([0.1 * along, np.zeros(3)])
    force = np.concatenate([10.0 * (normal - friction * along), np.zeros(3)])
    source = HapticExploration(
        LatestReference(reference(task(velocity=velocity))),
        ExplorationConfig(direction=direction),  # type: ignore[arg-type]
    )
    out, _ = play(source, 250, foot=force)
    offset = out.diagnostics["exploration/foot/offset"]
    return np.array([offset @ normal, offset @ along]) / np.linalg.norm(offset)


@pytest.mark.parametrize("friction", [0.0, 0.3, 0.8])
def test_offset_follows_the_normal_whatever_the_friction(friction: float) -> None:
    along_normal, along_tangent = slide("normal", friction, 0.3)
    assert along_normal < -0.99
    assert abs(along_tangent) < 0.1
    assert abs(slide("axes", friction, 0.3)[1]) > 0.25  # baseline: straight down leaks into the tangent


def test_normal_is_left_alone_at_rest_and_kept_in_its_cone() -> None:
    up, force = (0.0, 0.0, 1.0), (5.0, 0.0, 10.0)
    assert turned_normal(up, force, (0.0, 0.0, 0.0), 1.0, PERIOD, 0.05, 2.0) == up
    turned = turned_normal(up, force, (0.0, 0.1, 0.0), 1.0, PERIOD, 0.05, 2.0)
    assert 0.0 < angle_between(up, turned) <= 2.0 * PERIOD * 1.01
    far = (math.sin(1.2), 0.0, math.cos(1.2))
    assert angle_between(up, within_cone(far, up, 0.5)) == pytest.approx(0.5)
    assert within_cone((0.0, 0.0, -1.0), up, 0.5) == up


def test_normal_mode_keeps_the_bound_of_every_axis() -> None:
    force = (8, 3, 2, 0, 0, 0)
    velocity = np.array([0.0, 0.05, 0.02, 0, 0, 0])
    source = HapticExploration(
        LatestReference(reference(task(velocity=velocity))), ExplorationConfig(direction="normal")
    )
    state = source.init(estimate(0))
    last = np.zeros(3)
    for tick in range(600):
        out, state = source.step(estimate(tick, foot=force), state)
        offset = out.diagnostics["exploration/foot/offset"]
        assert np.all(np.abs(offset) <= 0.02)
        assert np.all(np.abs(offset - last) <= 0.3 * PERIOD + 1e-12)  # nothing jumps
        last = offset
