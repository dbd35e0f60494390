"""A surface whose stiffness changes along the way: as the task says it, in the simulation, and felt by a controller."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from pliant import run
from pliant.configuration import merged, validated
from pliant.errors import ConfigError
from pliant.studies.task.build import planned
from pliant.studies.task.config import TaskCase
from pliant.studies.task.study import study_of
from pliant.studies.task.world import feel_of, true_surface

ALONG_X = {"along": "x", "values": [[-0.05, 3e3], [0.05, 1e5]]}


def wiping(**truth: Any) -> TaskCase:
    study = study_of("wipe-hardening")
    return merged(study.case("wipe-hardening"), {"truth": truth})


def test_the_line_lies_in_the_true_surface() -> None:
    case = wiping(tilt=4.0, shift=0.003)
    made = planned(case)
    true = true_surface(case, made.surface, made.path)
    change = true.touch.change
    assert change is not None
    np.testing.assert_allclose(change.origin, true.geometry.origin)
    np.testing.assert_allclose(change.direction, true.geometry.rotation[:, 0])
    assert np.abs(np.subtract(change.direction, made.surface.rotation[:, 0])).max() > 1e-3  # the control: it is tilted
    assert change.stiffness == (3e3, 1e5)
    assert change.damping == (case.surface.damping,) * 2


def test_stiffness_and_damping_share_their_places() -> None:
    case = wiping(stiffness=ALONG_X, damping={"along": "x", "values": [[0.0, 50.0], [0.1, 250.0]]})
    change = feel_of(case, planned(case).surface).change
    assert change is not None
    assert change.places == (-0.05, 0.0, 0.05, 0.1)
    np.testing.assert_allclose(change.stiffness, (3e3, 51500.0, 1e5, 1e5))
    np.testing.assert_allclose(change.damping, (50.0, 50.0, 150.0, 250.0))


def test_what_cannot_be_says_so() -> None:
    with pytest.raises(
        ConfigError, match=r"places of a value that changes along a surface must rise, got \[0\.1, 0\.0"
    ):
        validated(TaskCase, {"truth": {"stiffness": {"values": [[0.1, 1e3], [0.0, 1e4]]}}})
    across = wiping(damping={"along": "y", "values": [[0.0, 50.0], [0.1, 250.0]]})
    with pytest.raises(ConfigError, match=r"change along one axis, got \['x', 'y'\]"):
        feel_of(across, planned(across).surface)
    nothing = wiping(stiffness={"along": "x", "values": [[0.0, 0.0], [0.1, 1e4]]})
    with pytest.raises(ConfigError, match="stiffness must be above zero"):
        feel_of(nothing, planned(nothing).surface)
    with pytest.raises(ConfigError, match="set contact = 'explicit'"):
        run("wipe-hardening", **{"simulation.contact": "mujoco"})


@pytest.mark.study
def test_the_stiffness_is_felt_on_the_way() -> None:
    felt, blind = (run("wipe-hardening", seed=0, **{"estimation.changing": changing}) for changing in (True, False))
    assert felt.failure is None
    assert felt.metrics["contact_lost"].value == 0.0
    assert felt.metrics["force_error"].value < 0.5
    assert felt.metrics["force_error_max"].value < 5.0
    assert blind.metrics["force_error_max"].value > 7.0  # control: 3e4 N/m all the way
    known = felt.log["estimate/tool/stiffness"].ravel()
    assert known.min() < 4e3
    assert known.max() > 4e4
    assert 0.05 < len(known) / len(felt.log.time()) < 0.95  # neither all the time nor hardly ever
