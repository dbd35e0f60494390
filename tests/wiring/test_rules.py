"""Each suggested value has a rule, each rule of the package is used, and the assumed noise sets what it should."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import pliant
from pliant.entries import Believed, ControllerEntry
from pliant.experiments.choice import chosen
from pliant.experiments.origins import SUGGESTED, Origin, leaves, origins
from pliant.rigid_body import mass_matrix
from pliant.robot import Robot, Tool
from pliant.rules import Rule, rule_of
from pliant.signals import ImpedanceTuning
from pliant.surfaces import PlaneSurface
from pliant.wiring.noise import Noise
from pliant.wiring.registry import controllers, find_controller
from pliant.wiring.wire import parameters_for

FORCED = Believed(
    ("tool",),
    1e-3,
    presses="tool",
    surface=PlaneSurface.facing((0.0, 0.1, 1.0), (0.5, 0.0, 0.1)),
    stiffness=1e5,
    damping=100.0,
)
WORLDS = (
    FORCED,
    replace(FORCED, sensing_delay=1e-3, computation_delay=5e-3, period=3e-3, noise_force=2.0),
    replace(FORCED, compensation="gravity", phases={"approach": False, "press": True}),
    replace(FORCED, phases={"slide": True}, axes={"slide": ("yield", "motion", "press")}, computation_delay=3e-3),
    replace(FORCED, presses=None, stiffness=None, damping=None, surface=None, oriented=False),
    replace(FORCED, tunings={"tool": ImpedanceTuning(np.full(3, 900.0), np.full(3, 60.0), np.full(3, 0.1))}),
)


@pytest.fixture(scope="module")
def arm() -> Robot:
    return Robot.load("iiwa14", tool=Tool())


def changed_keys(entry: ControllerEntry[Any], arm: Robot, believed: Believed) -> list[str]:
    made = parameters_for(entry, arm, believed, {})
    return [".".join(path) for path, value, _, usual in leaves(made, entry.default) if value != usual]


def test_each_change_has_a_rule_and_each_rule_makes_a_change(arm: Robot) -> None:
    """Searched over worlds that are late, prompt, noisy, stiff, with modes, with phases, and without a force."""
    used, offered = set[Rule](), set[Rule]()
    for entry in controllers().values():
        offered |= set(entry.rules)
        for believed in WORLDS:
            for key in changed_keys(entry, arm, believed):
                rule = rule_of(entry.rules, key)
                assert rule is not None, f"{entry.name} changes {key} without a rule"
                used.add(rule)
    presets = {"costs.*", "contact.*"}  # where a task begins, before anything is suggested
    assert {rule.keys for rule in offered - used} <= presets


def test_a_change_without_a_rule_is_found(arm: Robot) -> None:
    entry = find_controller("haptic")
    silent = replace(entry, rules=tuple(rule for rule in entry.rules if rule.keys != "exploration.gain"))
    assert any(rule_of(silent.rules, key) is None for key in changed_keys(silent, arm, WORLDS[1]))


def shown(controller: str, **changes: Any) -> dict[str, Origin]:
    choice = chosen("wipe", None, {"controller": controller, "robot": "iiwa14"}, changes)
    return {row.key: row for row in origins(choice, choice.study.build(choice.config).parameters)}


@pytest.mark.parametrize("controller", ["haptic", "offset-free-mpc"])
def test_what_is_assumed_and_suggested_is_said(controller: str) -> None:
    rows = shown(controller)
    for key in ("timing.sensing_delay", "timing.computation_delay", "estimation.noise_position"):
        assert rows[key].origin.startswith("assumed: ")
    assert all(row.rule is not None for row in rows.values() if row.origin == SUGGESTED)
    assert rows["phases.approach_speed"].value == 0.05
    given = shown(controller, timing={"sensing_delay": 2e-3}, estimation={"joint_memory": 0.5})
    assert given["timing.sensing_delay"].origin == "changes"
    assert given["estimation.joint_memory"].origin == "changes"
    assert given["timing.computation_delay"].origin.startswith("assumed: ")


def test_a_stiffer_surface_is_met_more_slowly_and_with_a_stiffer_model() -> None:
    soft = shown("offset-free-mpc", surface={"stiffness": 2e4})
    stiff = shown("offset-free-mpc", surface={"stiffness": 1e5})
    key = "control.offset-free-mpc.contact.stiffness"
    assert soft[key].value == (3e4,)
    assert soft[key].origin == "default"
    assert 3e4 < stiff[key].value[0] <= 1e5
    assert stiff[key].origin == SUGGESTED
    assert stiff["phases.approach_speed"].value < 0.7 * soft["phases.approach_speed"].value
    own = shown("offset-free-mpc", surface={"stiffness": 1e5}, phases={"approach_speed": 0.05})
    assert (own["phases.approach_speed"].value, own["phases.approach_speed"].origin) == (0.05, "changes")


def test_a_rule_stands_for_its_keys_and_the_first_one_counts() -> None:
    rules = (Rule("a.*.b", "one", "x"), Rule("a.*", "two", "y"))
    assert rule_of(rules, "a.1.b") is rules[0]
    assert rule_of(rules, "a.1.c") is rules[1]
    assert rule_of(rules, "b.a") is None
    assert rules[0].under("top").keys == "top.a.*.b"
    assert rules[0].told == "one (x)"


def test_memory_and_force_of_the_assumed_noise() -> None:
    """0.3 s σ_q / σ_v; four deviations of a force whose variance falls to 2.22 f_c T."""
    assert Noise().joint_memory() == 0.3
    assert Noise(position=2e-3, velocity=1e-3).joint_memory() == pytest.approx(0.6)
    assert Noise(velocity=0.0).joint_memory() == 3.0
    assert Noise(position=0.0).joint_memory() == 0.0
    assert Noise().least_force(30.0, 1e-3) == 0.1
    assert Noise(force=1.0).least_force(30.0, 1e-3) == pytest.approx(4.0 * math.sqrt(0.0666))
    assert Noise().depth(0.3) == 2.3e-5
    assert Noise(position=4e-3).depth(1.2) == pytest.approx(2.0 * 2.3e-5)
    assert Noise().depth(0.0) == 5e-4


def test_the_observer_is_slower_where_its_noise_would_be_felt(arm: Robot) -> None:
    """k M σ_v is at most 1 % of each joint's limit."""
    M = np.diag(mass_matrix(arm.model, arm.model.createData(), arm.home))
    for velocity in (1e-3, 0.05, 0.5):
        gain = Noise(velocity=velocity).observer_gain(arm)
        assert gain <= 30.0
        assert np.all(gain * M * velocity <= 0.01 * arm.torque_limit * (1.0 + 1e-9))
    assert Noise().observer_gain(arm) == 30.0
    assert Noise(velocity=0.5).observer_gain(arm) < 10.0


def test_a_noisy_force_sensor_begins_no_contact_by_its_noise(arm: Robot) -> None:
    """White noise through the exploration's filter stays below the threshold that is suggested, and above the usual."""
    entry, noise, T = find_controller("haptic"), 4.0, 1e-3
    late = replace(FORCED, computation_delay=5e-3, noise_force=noise)
    usual, rules = entry.default.exploration, entry.suggest(arm, entry.default, late).exploration
    share, felt, highest = T / (rules.contact_filter + T), 0.0, 0.0
    for force in np.random.default_rng(1).normal(0.0, noise, 20_000):
        felt += share * (force - felt)
        highest = max(highest, abs(felt))
    assert usual.contact_on < highest < rules.contact_on
    assert rules.contact_off < rules.contact_on


def test_a_stiff_surface_is_landed_on_and_left() -> None:
    """1e5 N/m, a late imperfect arm: a model that is too soft makes the first touch too hard."""
    task = {"robot": "ur5e", "path": {"size": [0.04, 0.02]}, "force": {"along": "estimated"}}

    def run(**more: Any) -> Any:
        return pliant.run("wipe", controller="offset-free-mpc", surface={"stiffness": 1e5}, **task, **more)

    made = run()
    assert made.failure is None
    assert made.metrics["force_error"].value < 0.7
    soft = {"offset-free-mpc": {"contact": {"stiffness": [3e4]}}}
    assert "limits.force was exceeded" in str(run(phases={"approach_speed": 0.05}, control=soft).failure)


def test_the_page_has_the_rules() -> None:
    """Its tables are written by `benchmarks/rules.py`; a rule that was changed since is not on it."""
    page = (Path(__file__).parents[2] / "docs/suggestions.md").read_text("utf-8")
    rules = {rule for entry in controllers().values() for rule in entry.rules}
    assert len(rules) > 20
    assert [rule.keys for rule in rules if f"| `{rule.keys}` | {rule.says} | {rule.source} |" not in page] == []
