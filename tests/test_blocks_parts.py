"""Blocks of ticks: somebody's own parts and observers, and references that cannot be foreseen."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from pliant.compiled import unchanged
from pliant.controllers.stack import Stack
from pliant.controllers.step_limit import StepLimit
from pliant.errors import RunFailedError
from pliant.references.postures.posture_source import PostureSource
from pliant.references.retuned import Retuned, TuningChange
from pliant.references.trajectories.trajectory import Hold, Trajectory
from pliant.signals import Command, Estimate, Reference
from pliant.wiring.experiment import Experiment
from tests.both_loops import Counts, both, run
from tests.test_blocks import wired


class Weaker(Stack):
    """Somebody's own controller, made of the stack."""

    def step(self, estimate: Estimate, reference: Reference, state: Any) -> tuple[Command, Any]:
        command, state = super().step(estimate, reference, state)
        return replace(command, torque=0.999 * command.torque), state


def weaker() -> Experiment:
    limit = wired().controller
    assert isinstance(limit, StepLimit)
    inner = limit.inner
    assert isinstance(inner, Stack)
    stack = Weaker(inner.robot, inner.tasks, inner.period, law=inner.law, phases=inner.phases)
    return replace(wired(), controller=StepLimit(stack, wired().robot))


def test_a_controller_in_python_means_the_loop_in_python() -> None:
    outcome, counts = both(weaker(), 300)
    assert counts.blocks == []
    assert outcome.ticks == 300
    assert run(weaker(), 300, python=False)[0] != run(wired(), 300, python=False)[0]


def test_an_observer_that_wants_every_tick_means_the_loop_in_python() -> None:
    seen: list[float] = []
    counts = Counts()
    wired().run(range(20), [counts, lambda tick: seen.append(tick.measurement.time)])
    assert len(seen) == counts.single == 20
    assert counts.blocks == []


def test_what_is_put_in_place_of_a_method_is_noticed() -> None:
    stack = Stack.__new__(Stack)
    assert unchanged(stack, "compiled_face") is not None
    assert unchanged(Weaker.__new__(Weaker), "compiled_face") is None
    stack.step = lambda *_: None  # type: ignore[method-assign, assignment]
    assert unchanged(stack, "compiled_face") is None
    assert unchanged(object(), "compiled_face") is None


def test_what_is_put_into_the_class_itself_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    def step(self: Stack, *given: Any) -> Any:
        return plain(self, *given)

    plain = Stack.step
    _, counts = both(wired(), 60)
    assert counts.blocks
    monkeypatch.setattr(Stack, "step", step)
    _, counts = both(wired(), 60)
    assert counts.blocks == []


def test_an_observer_with_something_else_of_that_name_wants_every_tick() -> None:
    class Sized(Counts):
        take_block = 64  # type: ignore[assignment]

    seen = Sized()
    wired().run(range(20), [seen])
    assert seen.single == 20


# ---------------------------------------------------------------------- references that cannot be foreseen


def pressing(
    experiment: Experiment, changes: Sequence[TuningChange] = (), force: Trajectory | None = None
) -> Experiment:
    """The case with a wrench of its tool's motion and changes of its tuning, and a stack of that task alone."""
    source, stack = experiment.source.inner, experiment.controller.inner
    motion = replace(source.motion, wrench=force or Hold(np.zeros(6)))
    tool = Stack(stack.robot, stack.tasks[:1], stack.period)
    return replace(experiment, source=Retuned(PostureSource(motion, source.path, {}, {}), changes), controller=tool)


@pytest.mark.parametrize("time", [0.017, 0.1, 0.273])
def test_a_change_in_the_first_tick_of_a_block(time: float) -> None:
    case = wired("calibration")
    (tuning, *_) = [change.tuning for change in case.source.changes if change.frame == case.source.inner.motion.frame]
    outcome, counts = both(pressing(case, [TuningChange(time, case.source.inner.motion.frame, tuning)]), 400)
    assert outcome.failure is None
    assert counts.blocks


class Ending(Hold):
    """A wrench that is not known from some time on."""

    def at(self, time: float) -> Any:
        if time >= 0.244:
            raise RunFailedError("no further")
        return super().at(time)


def test_an_error_of_a_reference_ends_the_run_in_its_own_tick() -> None:
    outcome, counts = both(pressing(wired("calibration"), force=Ending(np.zeros(6))), 400)
    assert outcome.failure is not None
    assert "no further" in outcome.failure
    assert outcome.ticks == 244
    assert counts.blocks
