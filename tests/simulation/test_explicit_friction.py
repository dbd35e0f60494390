"""The friction of the explicit contact law: it sticks, slides and rolls."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from pliant.simulation import Ball, Box, Plane, floor
from pliant.simulation.contact.material import ContactMaterial
from tests.simulation.bench import RIGID, Bench, G, bench

EDGE = 0.1  # m, half edge of the block


def block_on_slope(tilt: float, material: Callable[[ContactMaterial], ContactMaterial] | None = None) -> Bench:
    """A 2 kg block lying on a plane tilted about y.

    Gravity first presses it onto the plane and then turns upright within 0.2 s. Let go at once, the block would already
    slide when its weight arrives on the plane, and between the two coefficients it would go on sliding, as it should.
    """
    normal = (np.sin(tilt), 0.0, np.cos(tilt))
    centre = EDGE * np.array(normal)
    block = Box("block", (2 * EDGE, 2 * EDGE, 2 * EDGE), tuple(centre), 2.0, (0.0, tilt, 0.0), RIGID)
    b = bench([block, Plane("slope", (0.0, 0.0, 0.0), normal, RIGID)], material=material)
    for share in np.linspace(0.0, 1.0, 101):
        angle = (1.0 - share) * tilt
        b.model.opt.gravity = [-G * np.sin(angle), 0.0, -G * np.cos(angle)]
        b.run(2e-3)
    return b


def downhill(b: Bench, tilt: float) -> tuple[float, float]:
    """Distance and speed along the slope."""
    along = np.array([np.cos(tilt), 0.0, -np.sin(tilt)])
    return float(b.data.qpos[:3] @ along), float(b.data.qvel[:3] @ along)


@pytest.mark.parametrize("degrees", [2.0, 15.0, 24.0])
def test_a_block_sticks_on_a_slope_below_the_friction_angle(degrees: float) -> None:
    tilt = np.deg2rad(degrees)
    assert np.tan(tilt) < RIGID.friction
    b = block_on_slope(tilt)
    b.run(0.3)
    before, _ = downhill(b, tilt)
    b.run(0.7)
    after, _ = downhill(b, tilt)
    assert abs(after - before) / 0.7 < 1e-6  # m/s


def test_a_capped_viscous_friction_creeps_on_the_same_slope() -> None:
    tilt = np.arcsin(5.0 / (2.0 * G))  # a load of 5 N downhill

    def viscous(material: ContactMaterial) -> ContactMaterial:
        # 5 N at 1 mm/s, shared by the four corners the block stands on.
        return replace(material, tangential_stiffness=0.0, tangential_damping=5.0 / 1e-3 / 4.0)

    creep = []
    for b in (block_on_slope(tilt), block_on_slope(tilt, viscous)):
        b.run(0.3)
        before, _ = downhill(b, tilt)
        b.run(0.5)
        creep.append(abs(downhill(b, tilt)[0] - before) / 0.5)
    assert creep[0] < 1e-6
    assert creep[1] == pytest.approx(1e-3, rel=0.05)


@pytest.mark.parametrize("degrees", [30.0, 40.0])
def test_above_the_friction_angle_it_slides_with_the_dynamic_coefficient(degrees: float) -> None:
    tilt = np.deg2rad(degrees)
    assert np.tan(tilt) > RIGID.friction
    b = block_on_slope(tilt)
    b.run(0.1)
    _, early = downhill(b, tilt)
    b.run(0.2)
    _, late = downhill(b, tilt)
    expected = G * (np.sin(tilt) - 0.3 * np.cos(tilt))
    assert (late - early) / 0.2 == pytest.approx(expected, rel=0.01)


def test_between_the_two_coefficients_a_resting_block_stays_and_a_moving_one_goes_on() -> None:
    tilt = np.deg2rad(21.0)  # tan 21° = 0.38
    at_rest, moving = block_on_slope(tilt), block_on_slope(tilt)
    moving.data.qvel[:3] = 0.2 * np.array([np.cos(tilt), 0.0, -np.sin(tilt)])
    for b in (at_rest, moving):
        b.run(0.3)
    assert abs(downhill(at_rest, tilt)[1]) < 1e-6
    expected = 0.2 + 0.3 * G * (np.sin(tilt) - 0.3 * np.cos(tilt))
    assert downhill(moving, tilt)[1] == pytest.approx(expected, rel=0.02)


def test_a_sliding_ball_ends_up_rolling_at_five_sevenths_of_its_speed() -> None:
    surface = replace(RIGID, friction_moving=None)
    b = bench([Ball("ball", 0.1, (0.0, 0.0, 0.1), 0.5, surface), floor(0.0, surface)])
    b.run(0.1)
    b.data.qvel[0] = 1.0
    b.run(0.5)
    assert b.data.qvel[0] == pytest.approx(5.0 / 7.0, rel=5e-3)
    assert b.data.qvel[4] * 0.1 == pytest.approx(b.data.qvel[0], rel=2e-3)
