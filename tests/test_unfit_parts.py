"""Parts that do not fit together are named before anything is sent."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from pliant import loop
from pliant.errors import ConfigError, ShapeError
from pliant.guard import Guard
from pliant.robot import Robot
from pliant.signals import Command, Estimate, Reference
from tests.guarded_leg import Still, command, reading


def test_what_a_plant_says_of_itself_is_checked() -> None:
    plant = Still()
    plant.period = np.nan
    with pytest.raises(ConfigError, match="period must be finite and above zero, got nan s"):
        Guard(plant)
    with pytest.raises(ConfigError, match="noisy sensors must be fields of Measurement, got 'speed'"):
        Guard(Still(frozenset({"speed"})))


@pytest.mark.parametrize(
    ("part", "answer", "error", "sentence"),
    [
        ("plant", None, ConfigError, "the plant must give a Measurement, got NoneType"),
        (
            "plant",
            replace(reading(0.0), v=np.zeros(4)),
            ShapeError,
            r"measurement's v must have shape \(3,\)",
        ),
        (
            "plant",
            replace(reading(0.0), wrenches={"foot": np.zeros(3)}),
            ShapeError,
            "wrench at 'foot' must have",
        ),
        ("estimator", 3, ConfigError, "the estimator must give Estimate, got int"),
        ("estimator", Estimate(0.0, *[np.zeros(4)] * 4), ShapeError, r"the first estimate's q must have shape \(3,\)"),
        ("source", None, ConfigError, "the source must give Reference, got NoneType"),
        ("controller", None, ConfigError, "the controller must give Command, got NoneType"),
        (
            "controller",
            Command(0.0, np.zeros(2), np.zeros(2)),
            ShapeError,
            "command's torque must have shape",
        ),
    ],
)
def test_parts_that_do_not_fit_are_named_before_anything_is_sent(
    part: str, answer: Any, error: type[Exception], sentence: str
) -> None:
    sound = {"plant": reading(0.0), "estimator": Estimate(0.0, *[np.zeros(3)] * 4), "source": Reference(0.0)}
    said: dict[str, Any] = {**sound, "controller": command(), part: answer}
    plant = Still()
    plant.init = lambda: (said["plant"], None)  # type: ignore[method-assign]
    plant.step = lambda command, world: pytest.fail("something was sent")  # type: ignore[method-assign]
    parts = [Says(said[name]) for name in ("estimator", "source", "controller")]
    with pytest.raises(error, match=sentence):
        loop.run(plant, *parts, range(3), robot=Robot.load("leg3"))  # type: ignore[arg-type]


class Says:
    """Any part: it gives the same answer at every step."""

    def __init__(self, answer: Any) -> None:
        self.answer = answer

    def init(self, signal: object) -> None:
        return None

    def step(self, *signals: object) -> tuple[Any, None]:
        return self.answer, None
