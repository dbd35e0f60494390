"""What haptic exploration is suggested: how fast it regulates, the least stiffness it believes, and its damping."""

from __future__ import annotations

from collections import deque
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import pliant
from pliant.entries import Believed
from pliant.references.exploration.rules import AxisLimits, AxisRules
from pliant.robot import Robot, Tool
from pliant.signals import ImpedanceTuning
from pliant.wiring.recipes import HapticConfig
from pliant.wiring.registry import find_controller
from tests.twins.exploration.axis import ExploredAxis

CONTACT, IMPEDANCE, INERTIA, DAMPING = 2e4, 2500.0, 3.0, 270.0  # N/m, N/m, kg, N·s/m: a mode of 13 Hz
BELIEVED = Believed(("tool",), 1e-3, presses="tool", stiffness=CONTACT)


def suggested(arm: Robot, late: float, name: str = "haptic", **more: Any) -> HapticConfig:
    """Args: late: s, period and delays."""
    entry = find_controller(name)
    return entry.suggest(arm, entry.default, replace(BELIEVED, computation_delay=late - 1e-3, **more))


@pytest.fixture(scope="module")
def arm() -> Robot:
    return Robot.load("panda", tool=Tool())


def test_force_is_regulated_as_slowly_as_the_loop_is_late(arm: Robot) -> None:
    """k_I ≤ 0.18 / (period + both delays), 1/s; a loop that is quick enough keeps its own."""
    own = find_controller("haptic").default.exploration.gain  # type: ignore[attr-defined]
    for late, gain in ((1e-3, own), (7e-3, 0.18 / 7e-3), (14e-3, 0.18 / 14e-3)):
        found = suggested(arm, late).exploration
        assert found is not None
        assert found.gain == pytest.approx(gain)


@pytest.mark.parametrize(
    ("late", "believed", "floor"),
    [(1e-3, 2e4, 300.0), (7e-3, 2e4, 0.6 * 2500 / 1.125), (7e-3, 500.0, 300.0), (7e-3, None, 0.6 * 2500 / (11 / 6))],
)
def test_a_late_loop_believes_no_contact_to_be_much_softer_than_told(
    late: float, believed: float | None, floor: float, arm: Robot
) -> None:
    """0.6 of contact and impedance in series, 3e3 N/m where nothing is believed, 300 N/m at least."""
    found = suggested(arm, late, stiffness=believed).exploration
    assert found is not None
    assert found.stiffness_floor == pytest.approx(floor)


def test_motion_is_damped_in_late_and_in_prompt_loops(arm: Robot) -> None:
    """Not where the task says its own impedance, nor for the printed algorithm, in a prompt loop."""
    own = {"tool": ImpedanceTuning(np.full(3, 2500.0), np.full(3, 100.0), np.full(3, 0.06))}

    def damping(late: float, name: str = "haptic", **more: Any) -> float:
        return suggested(arm, late, name, **more).impedance.motion_damping

    assert damping(1e-3) == 30.0
    assert damping(1e-3, tunings=own) == damping(1e-3, "haptic-paper") == damping(1e-3, presses=None) == 0.0
    assert damping(7e-3) == damping(7e-3, tunings=own) == pytest.approx(0.4 / 7e-3)


def highest(rules: AxisRules, late: int) -> float:
    """N: after a step from 5 to 10 N on a mass on its contact, felt `late` periods of 1 ms later."""
    axis, x, v = ExploredAxis(), 5.0 / CONTACT, 0.0
    start, felt = x + 5.0 / IMPEDANCE, deque([5.0] * late, maxlen=late)
    forces: list[float] = []
    for tick in range(1000):
        felt.append(CONTACT * x)
        wanted = 5.0 if tick < 100 else 10.0
        axis.step(rules, AxisLimits(IMPEDANCE, 100.0, 0.06), wanted, felt[0], 0.0, 1e-3 * tick, 1e-3)
        for _ in range(10):
            v += (IMPEDANCE * (start - axis.offset - x) - DAMPING * v - CONTACT * x) / INERTIA * 1e-4
            x += v * 1e-4
        forces.append(CONTACT * x)
    assert forces[-1] == pytest.approx(10.0, abs=0.01)
    return max(forces)


def test_a_late_force_overshoots_less_with_the_suggested_floor(arm: Robot) -> None:
    """A late answer makes the contact seem soft, which lets the target run: the default floor is the control."""
    found = suggested(arm, 7e-3).exploration
    assert found is not None
    rules = AxisRules.of(found, rotation=False)
    assert highest(rules, 7) < 11.6
    assert highest(replace(rules, stiffness_floor=300.0), 7) > 15.0


@pytest.mark.study
def test_a_prompt_loop_holds_a_force_without_a_limit_cycle() -> None:
    """25 N on 100 mm, perfect arm: no line of the spectrum above 2 %; without the damping one is above 5 %."""
    task: dict[str, Any] = {
        "timing": {"sensing_delay": 0.0, "computation_delay": 0.0},
        "truth": {"shift": 0.0, "tilt": 0.0, "imperfections": "none"},
        "path": {"pattern": "line", "size": (0.1, 0.1)},
        "force": {"normal": 25.0},
    }

    def line(**more: Any) -> float:
        made = pliant.run("wipe", controller="haptic", **task, **more)
        assert made.failure is None
        return made.metrics["force_line"].value

    assert line() < 2.0
    assert line(control={"haptic": {"impedance": {"motion_damping": 0.0}}}) > 5.0
