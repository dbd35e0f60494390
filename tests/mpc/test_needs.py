"""What is suggested to a predictive controller from what is believed of a contact."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pliant.entries import Believed
from pliant.mpc.config import MpcConfig
from pliant.robot import Robot, Tool
from pliant.wiring.registry import find_controller

BELIEVED = Believed(frames=("tool",), period=1e-3, presses="tool", stiffness=2e4, damping=80.0)


@pytest.fixture(scope="module")
def robot() -> Robot:
    return Robot.load("panda", tool=Tool())


def suggested(robot: Robot, name: str, believed: Believed) -> MpcConfig:
    entry = find_controller(name)
    found = entry.suggest(robot, entry.default, believed)
    assert isinstance(found, MpcConfig)
    return found


@pytest.mark.parametrize("name", ["force-feedback-mpc", "visco-elastic-mpc"])
def test_the_force_is_predicted_with_the_believed_stiffness(robot: Robot, name: str) -> None:
    contact = suggested(robot, name, BELIEVED).contact
    assert contact.stiffness == (2e4,)
    assert contact.damping == (80.0,)
    assert contact.integrator == "exponential"


@pytest.mark.parametrize("name", ["offset-free-mpc", "classical-mpc"])
def test_who_estimates_it_or_has_no_force_keeps_its_own(robot: Robot, name: str) -> None:
    assert suggested(robot, name, BELIEVED).contact.stiffness == find_controller(name).default.contact.stiffness


def test_without_a_belief_nothing_is_made_up(robot: Robot) -> None:
    unknown = replace(BELIEVED, stiffness=None, damping=None)
    default = find_controller("force-feedback-mpc").default
    assert suggested(robot, "force-feedback-mpc", unknown).contact.stiffness == default.contact.stiffness


@settings(max_examples=25, deadline=None)
@given(stiffness=st.floats(1.0, 1e7), damping=st.floats(0.0, 1e5))
def test_a_controller_can_be_built_whatever_is_believed(robot: Robot, stiffness: float, damping: float) -> None:
    believed = replace(BELIEVED, stiffness=stiffness, damping=damping)
    entry = find_controller("force-feedback-mpc")
    config = suggested(robot, "force-feedback-mpc", believed)
    assert 0.0 < config.contact.stiffness[0] <= stiffness
    assert entry.build(robot, config, 1e-3).needs.wrench
    assert np.isfinite(config.contact.stiffness[0])
