"""Parts that somebody else wrote and that have bad habits: whatever they do, only sound torques leave, the run ends in
order, and why is one line."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pliant import loop
from pliant.configuration import merged
from pliant.errors import ConfigError, PliantError
from pliant.experiments.base import Experiment
from pliant.experiments.registry import get_study
from pliant.signals import Command, Measurement
from pliant.telemetry import Recorder, RunInfo

SOUND = 10  # steps before the habit shows
Habit = Callable[[tuple[Any, ...], tuple[Any, Any], int], Any]
"""arguments of the step, what it should return, number of the step → what it does return"""
_KEPT = np.zeros(7)
INFO = RunInfo("stack", "hold", "mine", "lwr4", 0, tuple(f"A{n}" for n in range(1, 8)), (1.0,) * 7, {})


def gives(**changes: Any) -> Habit:
    def habit(given: tuple[Any, ...], answer: tuple[Any, Any], step: int) -> Any:
        signal, state = answer
        made = {key: change(getattr(signal, key)) if callable(change) else change for key, change in changes.items()}
        return replace(signal, **made), state

    return habit


def raises(error: BaseException) -> Habit:
    def habit(given: tuple[Any, ...], answer: tuple[Any, Any], step: int) -> Any:
        raise error

    return habit


def writes_into(number: int, field: str) -> Habit:
    """Spoils what it is given."""

    def habit(given: tuple[Any, ...], answer: tuple[Any, Any], step: int) -> Any:
        getattr(given[number], field)[:] = np.nan
        return answer

    return habit


def reuses_its_array(given: tuple[Any, ...], answer: tuple[Any, Any], step: int) -> Any:
    """Returns one array again and again, and writes into it afterwards."""
    _KEPT[:] = np.nan if step % 3 == 2 else answer[0].torque
    return replace(answer[0], torque=_KEPT), answer[1]


def masked(values: np.ndarray) -> Any:
    return np.ma.masked_invalid(np.where(np.arange(len(values)) == 2, np.nan, values))


class _Unprintable(Exception):
    def __str__(self) -> str:
        raise ZeroDivisionError


ANSWERS: dict[str, Habit] = {
    "none": lambda given, answer, step: None,
    "the signal alone": lambda given, answer, step: answer[0],
    "three things": lambda given, answer, step: (*answer, 1),
    "swapped": lambda given, answer, step: answer[::-1],
    "none as signal": lambda given, answer, step: (None, answer[1]),
    "time as text": gives(time="now"),
    "time as array": gives(time=np.zeros(3)),
    "exit": raises(SystemExit(3)),
    "generator exit": raises(GeneratorExit()),
    "no memory": raises(MemoryError()),
    "an endless error": raises(ValueError("a\nb" * 5000)),
    "an unprintable error": raises(_Unprintable()),
}
HABITS: dict[str, dict[str, Habit]] = {
    "controller": {
        "float32": gives(torque=lambda torque: torque.astype(np.float32)),
        "whole numbers": gives(torque=lambda torque: torque.astype(int)),
        "list": gives(torque=list),
        "booleans": gives(torque=lambda torque: torque > 0.0),
        "a column": gives(torque=lambda torque: torque[:, None]),
        "masked": gives(torque=masked),
        "text": gives(torque="x"),
        "clamped none": gives(clamped=None),
        "reuses its array": reuses_its_array,
        "writes into the estimate": writes_into(0, "q"),
        "diagnostics none": gives(diagnostics=None),
        "diagnostics list": gives(diagnostics=[1]),
        "diagnostics numbered": gives(diagnostics={5: 1.0}),
        "diagnostics of text": gives(diagnostics={"x": "y"}),
    },
    "estimator": {
        "list": gives(q=list),
        "masked": gives(q=masked),
        "wrenches none": gives(wrenches=None),
        "environments of text": gives(environments={"tool": "soft"}),
        "writes into the measurement": writes_into(0, "q"),
    },
    "source": {
        "tasks none": gives(tasks=None),
        "tasks of text": gives(tasks=("x",)),
        "no tasks": gives(tasks=()),
        "frame none": gives(tasks=lambda tasks: tuple(replace(task, frame=None) for task in tasks)),
        "frame unknown": gives(tasks=lambda tasks: tuple(replace(task, frame="nose") for task in tasks)),
        "masked": gives(tasks=lambda tasks: tuple(replace(task, position=masked(task.position)) for task in tasks)),
        "diagnostics none": gives(diagnostics=None),
        "tuning of a number": gives(tuning=5),
        "writes into the estimate": writes_into(0, "q"),
    },
}
CASES = [(part, name) for part in HABITS for name in (*HABITS[part], *ANSWERS)]


class Foreign:
    """A part that behaves for a while."""

    def __init__(self, inner: Any, habit: Habit) -> None:
        self.inner, self.habit, self.steps = inner, habit, 0

    def __getattr__(self, name: str) -> Any:
        return getattr(self.inner, name)

    def step(self, *given: Any) -> Any:
        answer = self.inner.step(*given)
        self.steps += 1
        return self.habit(given, answer, self.steps) if self.steps > SOUND else answer


def wired(**changes: Any) -> Experiment:
    study = get_study("stack")
    short = {"path": {"kind": "hold", "ramp": 0.0}, "duration": 0.1, **changes}
    return study.build(merged(study.case("figure8-plain"), short))


def sent_by(made: Experiment) -> tuple[list[np.ndarray], loop.Outcome | PliantError]:
    """Torques that reach the robot, and how the run ended."""
    sent: list[np.ndarray] = []
    step = made.plant.step

    def noting(command: Command, world: Any) -> tuple[Measurement, Any]:
        sent.append(np.array(command.torque))
        return step(command, world)

    made.plant.step = noting  # type: ignore[method-assign]
    try:
        with Recorder(None, INFO, channels=made.channels) as recorder:
            parts = made.plant, made.estimator, made.source, made.controller
            return sent, loop.run(*parts, range(80), [recorder], made.robot)
    except PliantError as error:
        return sent, error


@pytest.mark.parametrize(("part", "name"), CASES, ids=[f"{part}: {name}" for part, name in CASES])
def test_a_part_with_a_bad_habit_sends_nothing_that_is_not_sound(part: str, name: str) -> None:
    made, habit = wired(), (HABITS[part] | ANSWERS)[name]
    made = replace(made, **{part: Foreign(getattr(made, part), habit)})
    sent, ended = sent_by(made)
    assert len(sent) >= SOUND
    limit = made.robot.torque_limit * (1.0 + 1e-9)
    assert all(torque.shape == (7,) and np.isfinite(torque).all() for torque in sent)
    assert all((np.abs(torque) <= limit).all() for torque in sent)
    why = str(ended) if isinstance(ended, PliantError) else ended.failure
    assert why is None or (len(why.splitlines()) == 1 and len(why) < 600)


@pytest.mark.parametrize("part", list(HABITS))
def test_ctrl_c_inside_a_part_passes_through(part: str) -> None:
    made = wired()
    made = replace(made, **{part: Foreign(getattr(made, part), raises(KeyboardInterrupt()))})
    with pytest.raises(KeyboardInterrupt):
        sent_by(made)


CLASS = "from pliant.interfaces import Controller\nclass X(Controller):\n    init = step = lambda self, *a: None\n    "
FILES = {
    "exits": ("raise SystemExit(3)", "cannot be imported: SystemExit: 3"),
    "is not Python": ("def f(:", "cannot be imported: SyntaxError"),
    "has a null byte": ("a = 1\0", "cannot be imported"),
    "cannot be made": (f"{CLASS}def __init__(self, *a): 1 / 0", "cannot be made: ZeroDivisionError"),
    "takes nothing": (f"{CLASS}def __init__(self): pass", "cannot be made: TypeError"),
    "needs nothing known": (f"{CLASS}needs = 3\n    def __init__(self, *a): pass", "needs must be Needs"),
}


@pytest.mark.parametrize("name", FILES)
def test_a_file_with_a_controller_that_cannot_be_made_is_one_sentence(name: str, tmp_path: Path) -> None:
    code, words = FILES[name]
    (tmp_path / "mine.py").write_text(f"{code}\n")
    with pytest.raises(ConfigError, match=words) as caught:
        wired(controller=f"{tmp_path}/mine.py:X")
    assert len(str(caught.value).splitlines()) == 1
