"""Frozen values: made quickly, and with some fields changed."""

from __future__ import annotations

import inspect
import pickle
import sys
from dataclasses import FrozenInstanceError, dataclass, field, fields, replace
from typing import Any

import numpy as np
import pytest

from pliant.frozen import changed, quick
from pliant.signals import Estimate


def test_it_says_what_the_standard_library_says() -> None:
    zero = np.zeros(2)
    before = Estimate(1.0, zero, zero, zero, zero, {"tool": np.ones(6)})
    changes = {"q": np.ones(2), "disturbance": 2.0 * np.ones(2)}
    ours, theirs = changed(before, **changes), replace(before, **changes)
    for one in fields(Estimate):
        assert getattr(ours, one.name) is getattr(theirs, one.name)
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


def test_a_copy_keeps_and_gives_back_what_it_is_given() -> None:
    array, other = np.zeros(2), np.ones(2)
    one = Estimate(1.0, array, array, array, array)
    before = sys.getrefcount(array), sys.getrefcount(other)
    made = [changed(one, q=other, **{"".join(["tor", "que"]): other}) for _ in range(10)]
    assert (sys.getrefcount(array), sys.getrefcount(other)) == (before[0] + 20, before[1] + 20)
    assert all(each.q is other and each.torque is other and each.v is array for each in made)
    del made
    for _ in range(10):
        with pytest.raises(AttributeError):
            changed(one, q=other, speed=other)
    assert (sys.getrefcount(array), sys.getrefcount(other)) == before


class Body:
    a: float
    b: float = 2.0
    c: list[float] = field(default_factory=list[float])
    d: tuple[float, ...] = field(default_factory=tuple[float, ...])
    e: str = "e"

    def total(self) -> float:
        return self.a + self.b + sum(self.c) + sum(self.d)


def body_of(name: str) -> dict[str, Any]:
    return {**{k: v for k, v in vars(Body).items() if k not in ("__dict__", "__weakref__")}, "__qualname__": name}


Quick = quick(type("Quick", (), body_of("Quick")))
Plain = dataclass(frozen=True, slots=True)(type("Quick", (), body_of("Quick")))
CALLS: list[tuple[tuple[Any, ...], dict[str, Any]]] = [
    ((1.0,), {}),
    ((1.0, 3.0, [1.0], (2.0,), "x"), {}),
    ((1.0,), {"e": "y", "d": (5.0,)}),
    ((), {"c": [4.0], "a": 2.0}),
]


@pytest.mark.parametrize(("values", "named"), CALLS)
def test_a_quick_value_is_that_of_the_standard_library(values: tuple[Any, ...], named: dict[str, Any]) -> None:
    ours, theirs = Quick(*values, **named), Plain(*values, **named)
    assert repr(ours) == repr(theirs)
    assert ours.total() == theirs.total()
    assert ours == pickle.loads(pickle.dumps(ours)) == replace(ours)
    assert ours != replace(ours, a=7.0)
    with pytest.raises(FrozenInstanceError):
        ours.a = 5.0
    assert not hasattr(ours, "__dict__")


@pytest.mark.parametrize(
    ("values", "named"),
    [((), {}), ((1.0,), {"a": 2.0}), ((1.0,), {"f": 2.0}), ((1.0, 2.0, [], (), "x", 3.0), {}), ((), {"b": 1.0})],
)
def test_arguments_that_do_not_fit_are_refused_as_the_standard_library_does(
    values: tuple[Any, ...], named: dict[str, Any]
) -> None:
    with pytest.raises(TypeError) as ours:
        Quick(*values, **named)
    with pytest.raises(TypeError) as theirs:
        Plain(*values, **named)
    assert str(ours.value) == str(theirs.value)


class Checking:
    a: float
    kept: list[float] = field(default_factory=list[float])

    def __post_init__(self) -> None:
        if self.a < 0.0:
            raise ValueError("below zero")
        self.kept.append(self.a)


def test_a_value_that_checks_its_fields_does_so() -> None:
    made: Any = quick(Checking)
    assert made(2.0).kept == [2.0]
    with pytest.raises(ValueError, match="below zero"):
        made(-1.0)


def test_a_subclass_makes_its_own_values() -> None:
    class More(Estimate):
        def __init__(self) -> None:
            super().__init__(1.0, *4 * [np.zeros(2)])

    assert type(More()) is More
    assert More().time == 1.0


def test_a_value_keeps_and_gives_back_what_it_is_given() -> None:
    """A count that is off by one leaks each value's arrays, or frees them while they are used."""
    array, default = np.zeros(2), Estimate(1.0, *4 * [np.zeros(2)]).wrenches
    before = sys.getrefcount(array), sys.getrefcount(default)
    made = [Estimate(1.0, array, array, array, array) for _ in range(10)]
    assert (sys.getrefcount(array), sys.getrefcount(default)) == (before[0] + 40, before[1] + 40)
    del made
    for _ in range(10):
        with pytest.raises(TypeError):
            Estimate(1.0, array, torque=array)  # type: ignore[call-arg]
    assert (sys.getrefcount(array), sys.getrefcount(default)) == before


def test_quick_values_share_no_default_that_can_change() -> None:
    assert Quick(1.0).c is not Quick(1.0).c
    assert inspect.signature(Quick) == inspect.signature(Plain)


@pytest.mark.parametrize(("values", "named"), [((), {}), ((1.0,), {"f": 2.0}), ((1.0,), {"a": 2.0}), ((1.0,) * 6, {})])
def test_calls_that_do_not_fit_say_so_as_there(values: tuple[Any, ...], named: dict[str, Any]) -> None:
    with pytest.raises(TypeError) as ours:
        Quick(*values, **named)
    with pytest.raises(TypeError) as theirs:
        Plain(*values, **named)
    assert str(ours.value) == str(theirs.value)


def test_what_a_class_checks_when_it_is_made_is_checked() -> None:
    @quick
    class Checked:
        x: float

        def __post_init__(self) -> None:
            if self.x < 0.0:
                raise ValueError("below zero")

    assert Checked(1.0).x == 1.0
    with pytest.raises(ValueError, match="below zero"):
        Checked(-1.0)
