"""The compiled look at signals: what it passes is sound, and it passes what a loop is made of."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields, replace
from typing import Any

import numpy as np
import pytest

from pliant import _guard
from pliant.environment import Environment, EstimatedSurface
from pliant.guard import sound
from pliant.guard.faults import Fault
from pliant.signals import Command, Estimate, Measurement, Preview, Reference, TaskReference

N, FRAMES = 3, ("foot", "knee")
ONES = np.ones(N)
WRENCHES = {frame: np.ones(6) for frame in FRAMES}
READING = Measurement(0.1, ONES, ONES, ONES, ONES, WRENCHES)
KNOWN = Environment(1e4, 10.0, 100.0, np.inf)
ESTIMATE = Estimate(0.1, ONES, ONES, ONES, ONES, WRENCHES, {}, ONES, {"foot": KNOWN})
TASK = TaskReference("foot", np.ones(3), np.eye(3), task_rotation=np.eye(3)[:, ::-1])
AHEAD = Preview(np.ones(4), np.ones((4, 3)), np.ones((4, 3, 3)), np.ones((4, 6)), np.ones((4, 6)), (), np.ones((4, N)))
REFERENCE = Reference(0.1, (TASK, TASK), ONES, preview=AHEAD)
MASKED = np.ma.masked_array(np.ones(6), np.ones(6))
ODD: list[Any] = [
    None,
    3,
    "x",
    [1.0] * N,
    np.ones(6),
    np.ones(N, complex),
    np.ones(N, object),
    np.ones(N, ">f8"),
    MASKED,
]
ODD += [np.array([1.0, np.nan, 0.0]), np.full(N, np.inf), np.full(6, -np.inf), np.full(N, 1e200), np.ones((N, 1))]
ODD += [np.nan, np.inf, {"foot": np.ones(6)}, {"knee": np.ones(6), "foot": np.ones(6)}, {"foot": MASKED}, (1, 2), ONES]
ODD += [{"foot": replace(KNOWN, damping=np.nan)}, {"foot": replace(KNOWN, stiffness_std=-1.0)}, {"foot": np.ones(5)}]
ODD += [replace(AHEAD, time=np.ones(5)), replace(AHEAD, posture=ONES)]
ODD += [{"foot": EstimatedSurface(ONES, ONES, ONES, np.nan)}]
ODD += [(replace(TASK, frame=3),), (replace(TASK, wrench=ONES),), (replace(TASK, rotation=np.full((3, 3), np.nan)),)]

Look = Callable[[Any], bool]
LOOKS: list[tuple[Any, Look, Look]] = [
    (
        READING,
        lambda s: _guard.is_reading(s, N, FRAMES),
        lambda s: sound.reading_fault(s, N, FRAMES) is Fault.NONE,
    ),
    (ESTIMATE, lambda s: _guard.is_estimate(s, N), lambda s: sound.is_estimate(s, N)),
    (REFERENCE, lambda s: _guard.is_reference(s, N), lambda s: sound.is_reference(s, N)),
]


@pytest.mark.parametrize(("signal", "fast", "careful"), LOOKS, ids=["measurement", "estimate", "reference"])
def test_what_it_passes_is_sound(signal: Any, fast: Look, careful: Look, monkeypatch: pytest.MonkeyPatch) -> None:
    assert fast(signal)  # what a loop is made of
    passed = {
        (part.name, place): fast(replace(signal, **{part.name: odd}))
        for part in fields(signal)
        for place, odd in enumerate(ODD)
    }
    assert not all(passed.values())
    for name in ("is_reading", "is_estimate", "is_reference"):
        monkeypatch.setattr(_guard, name, lambda *_: False)  # the careful look alone
    assert careful(signal)
    for (name, place), by_the_fast_one in passed.items():
        if by_the_fast_one:
            assert careful(replace(signal, **{name: ODD[place]})), (name, ODD[place])
    refused = [key for key, by_the_fast_one in passed.items() if not by_the_fast_one]
    assert any(not careful(replace(signal, **{name: ODD[place]})) for name, place in refused)  # baseline


def test_arrays_with_steps_between_their_numbers_are_read() -> None:
    wide = np.ones((N, 2))
    assert _guard.is_estimate(replace(ESTIMATE, q=wide[:, 0]), N)
    wide[1, 0] = np.nan
    assert not _guard.is_estimate(replace(ESTIMATE, q=wide[:, 0]), N)
    assert _guard.is_estimate(replace(ESTIMATE, q=wide[:, 1]), N)


def test_a_torque_at_its_bound_is_within() -> None:
    bound = np.array([1.0, 2.0, np.inf])
    command = Command(0.1, np.array([-1.0, 2.0, 1e9]), np.zeros(N))
    assert _guard.is_command(command, N, bound)
    for torque in ([1.0 + 1e-12, 0.0, 0.0], [0.0, -2.1, 0.0], [np.nan, 0.0, 0.0], [0.0, 0.0]):
        assert not _guard.is_command(replace(command, torque=np.array(torque)), N, bound)
    assert _guard.is_command(replace(command, torque=np.full(N, 3.0)), N, None)
    no_array: Any = [0.0, 0.0, 0.0]  # not beyond doubt
    for other in ({"torque": no_array}, {"clamped": no_array}, {"clamped": np.full(N, np.nan)}, {"time": np.inf}):
        assert not _guard.is_command(replace(command, **other), N, bound)
