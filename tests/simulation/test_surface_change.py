"""A surface whose stiffness and damping change along a line presses as they are where it is touched."""

from __future__ import annotations

from dataclasses import replace

import mujoco
import numpy as np
import pytest

from pliant.errors import ConfigError
from pliant.simulation import Ball, Box, Plane, Scene, Surface, SurfaceChange, floor
from pliant.simulation.contact.explicit import explicit_contacts
from pliant.simulation.contact.pairs import pairs_of

R, DEPTH, RATE = 0.05, 2e-4, 0.1  # m, m, m/s
PLACES, STIFFNESS, DAMPING = (-0.1, 0.0, 0.3), (3e3, 2e4, 1e5), (50.0, 200.0, 100.0)
TILT = np.deg2rad(20.0)  # of the plane, and of the line on it, about the world's y axis
ALONG, NORMAL = np.array([np.cos(TILT), 0.0, -np.sin(TILT)]), np.array([np.sin(TILT), 0.0, np.cos(TILT)])
ORIGIN = (0.1, 0.0, 0.0)
CHANGE = SurfaceChange(ORIGIN, tuple(ALONG.tolist()), PLACES, STIFFNESS, DAMPING)
GRADED = Surface(friction=0.0, transition=0.0, change=CHANGE)


def pressing(s: float, surface: Surface, across: float = 0.02) -> float:
    """N of a ball that is DEPTH deep and goes deeper by RATE, s m along the line."""
    plane, ball = Plane("slope", ORIGIN, tuple(NORMAL.tolist()), surface), Ball("ball", R, (0.0, 0.0, 1.0), 2.0)
    spec = mujoco.MjSpec()
    spec.option.timestep = 2e-5
    spec.option.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
    scene = Scene((plane, ball), contact="explicit")
    for thing in scene.things:
        thing.add_to(spec)
    model = spec.compile()
    pairs = [(a, b, surface) for a, b, _ in pairs_of(scene, [])]
    data = mujoco.MjData(model)
    data.qpos[:3] = np.array(ORIGIN) + s * ALONG + across * np.array([0.0, 1.0, 0.0]) + (R - DEPTH) * NORMAL
    data.qpos[3:] = [1.0, 0.0, 0.0, 0.0]
    data.qvel[:3] = -RATE * NORMAL
    mujoco.mj_forward(model, data)
    contacts = explicit_contacts(model, np.zeros(0), pairs)
    return float(contacts.force_on(contacts.init(data), "ball") @ NORMAL)


@pytest.mark.parametrize("s", [-0.5, -0.1, -0.04, 0.0, 0.123, 0.3, 0.9])
def test_the_force_is_that_of_the_place(s: float) -> None:
    K, D = np.interp(s, PLACES, STIFFNESS), np.interp(s, PLACES, DAMPING)
    expected = pytest.approx(K * DEPTH + D * RATE, rel=1e-6)
    assert pressing(s, GRADED) == expected
    assert pressing(s, GRADED, across=-0.2) == expected
    same = pressing(s, Surface(2e4, 200.0, 0.0, transition=0.0))  # control: one material is right at one place only
    assert (same == expected) == (s == 0.0)


def test_the_physics_step_suits_the_stiffest_place() -> None:
    stiff = replace(CHANGE, stiffness=(3e3, 2e4, 1e11))
    with pytest.raises(ConfigError, match="too long for K = 1e"):
        pressing(0.0, replace(GRADED, change=stiff))


def test_what_cannot_change_says_so() -> None:
    with pytest.raises(ConfigError, match=r"'floor' changes along a line.*set contact = 'explicit'"):
        Scene((floor(surface=GRADED),))
    with pytest.raises(ConfigError, match="'crate' can move"):
        Scene((Box("crate", (0.1, 0.1, 0.1), (0.0, 0.0, 0.0), 1.0, surface=GRADED),), contact="explicit")
    for wrong, said in (
        ({"places": (0.0, 0.0, 0.3)}, "must rise"),
        ({"stiffness": (1e3, 0.0, 1e3)}, "above zero"),
        ({"damping": (1.0, -1.0, 1.0)}, "not be negative"),
        ({"stiffness": (1e3,)}, "at each place"),
        ({"direction": (1.0, 1.0, 0.0)}, "unit vector"),
    ):
        with pytest.raises(ConfigError, match=said):
            replace(CHANGE, **wrong)
