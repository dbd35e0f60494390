"""A frozen value with some fields changed."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

import numpy as np
import pytest

from pliant.frozen import changed
from pliant.signals import Estimate


def test_it_says_what_the_standard_library_says() -> None:
    zero = np.zeros(2)
    before = Estimate(1.0, zero, zero, zero, zero, {"tool": np.ones(6)})
    changes = {"q": np.ones(2), "disturbance": 2.0 * np.ones(2)}
    ours, theirs = changed(before, **changes), replace(before, **changes)
    for field in fields(Estimate):
        assert getattr(ours, field.name) is getattr(theirs, field.name)
    assert before.q is zero


def test_what_cannot_be_changed_is_refused() -> None:
    @dataclass(frozen=True)
    class Open:
        x: int = 0

    zero = np.zeros(2)
    with pytest.raises(AttributeError, match="Estimate has no field torques"):
        changed(Estimate(1.0, zero, zero, zero, zero), torques=zero)
    with pytest.raises(AttributeError):
        changed(Open(), x=1)
