"""The compiled step says what its readable twin says, on the same inputs, and names what it cannot answer."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from pliant.configuration import merged
from pliant.errors import ConfigError, PliantError, SignalError
from pliant.mpc import ForceFeedbackMpc, MpcConfig, MpcController, OffsetFreeMpc
from pliant.signals import Command, Estimate, Reference, TaskReference
from tests.twins.mpc_step.controller import TwinController

from .step_inputs import CASES, PERIOD, ROBOT, inputs


def furthest(ours: Command, theirs: Command) -> float:
    """The largest difference of two commands, relative to numbers above one; failures and status must be equal."""
    assert set(ours.diagnostics) == set(theirs.diagnostics)
    pairs: list[tuple[Any, Any]] = [(ours.torque, theirs.torque), (ours.clamped, theirs.clamped)]
    pairs += [(value, theirs.diagnostics[name]) for name, value in ours.diagnostics.items()]
    assert all(np.shape(a) == np.shape(b) for a, b in pairs)
    return max(float(np.max(np.abs(np.subtract(a, b)) / np.maximum(1.0, np.abs(b)))) for a, b in pairs)


@pytest.mark.parametrize("config", CASES.values(), ids=CASES.keys())
def test_the_compiled_step_is_its_twin(config: MpcConfig) -> None:
    ours, theirs = MpcController(ROBOT, config, PERIOD), TwinController(ROBOT, config, PERIOD)
    lead = ours.delays.lead
    assert lead == theirs.compensator.lead
    state, twin, sources, worst = None, None, set[float](), 0.0
    for estimate, reference in inputs(lead):
        state, twin = state or ours.init(estimate), twin or theirs.init(estimate)
        command, state = ours.step(estimate, reference, state)
        other, twin = theirs.step(estimate, reference, twin)
        worst = max(worst, furthest(command, other))
        sources.add(float(command.diagnostics["mpc/source"]))
    assert worst <= 1e-10
    assert sources >= {0.0, 1.0}  # plans were lost and found again


def test_a_twin_of_another_configuration_differs() -> None:
    """Baseline of the comparison: half a per cent of one cost shows."""
    base = ForceFeedbackMpc()
    heavier = {"torque": {"weight": 1.005 * base.costs.torque.weight}}
    ours, theirs = MpcController(ROBOT, merged(base, {"costs": heavier})), TwinController(ROBOT, base)
    estimate, reference = next(inputs(0.0))
    command, other = (made.step(estimate, reference, made.init(estimate))[0] for made in (ours, theirs))
    assert furthest(command, other) > 1e-6


@pytest.mark.parametrize(
    ("error", "words", "change"),
    [
        (SignalError, "contact wrench of frame 'tool'", lambda e, r: (replace(e, wrenches={}), r)),
        (SignalError, "MomentumObserver", lambda e, r: (replace(e, disturbance=None), r)),
        (SignalError, "a task for frame 'tool', it has", lambda e, r: (e, replace(r, tasks=r.tasks[1:], preview=None))),
        (SignalError, "must be finite", lambda e, r: (e, replace(r, tasks=(_at(r, np.nan),), preview=None))),
        (ConfigError, "-20 N along the surface's", lambda e, r: (e, replace(r, tasks=(_pulling(r),), preview=None))),
        (ConfigError, "no costs for phase 'polish'", lambda e, r: (e, replace(r, phase="polish", preview=None))),
        (
            ValueError,
            "rotation_reference must be a rotation",
            lambda e, r: (e, replace(r, tasks=(_flat(r),), preview=None)),
        ),
        (ValueError, r"must have shape \(6,\), got \(5,\)", lambda e, r: (replace(e, q=np.zeros(5)), r)),
    ],
)
def test_what_cannot_be_answered_is_named(
    error: type[Exception], words: str, change: Callable[[Estimate, Reference], tuple[Estimate, Reference]]
) -> None:
    controller = MpcController(ROBOT, OffsetFreeMpc(), PERIOD)
    estimate, reference = next(inputs(0.0))
    state = controller.init(estimate)
    with pytest.raises(error, match=words):
        controller.step(*change(estimate, reference), state)
    command, _ = controller.step(estimate, reference, state)
    assert np.isfinite(command.torque).all()  # and goes on afterwards


def _at(reference: Reference, height: float) -> TaskReference:
    return replace(reference.tasks[0], position=np.array([0.5, 0.0, height]))


def _pulling(reference: Reference) -> TaskReference:
    return replace(reference.tasks[0], wrench=np.array([0.0, 0.0, -20.0, 0.0, 0.0, 0.0]))


def _flat(reference: Reference) -> TaskReference:
    return replace(reference.tasks[0], rotation=np.ones((3, 3)))


def test_phases_that_do_not_fit_the_contact_are_named() -> None:
    config = merged(ForceFeedbackMpc(), {"phase_by": "contact"})
    only = config.model_copy(update={"phases": {"press": next(p for p in config.phases.values() if p.contact)}})
    controller = MpcController(ROBOT, only, PERIOD)
    estimate, reference = next(inputs(0.0))
    with pytest.raises(PliantError, match="needs a phase with contact = False"):
        controller.step(replace(estimate, contacts={}), replace(reference, preview=None), controller.init(estimate))


def test_arrays_of_other_kinds_count_by_their_numbers() -> None:
    """Strided, single-precision and whole numbers; baseline: other numbers give another torque."""
    controller = MpcController(ROBOT, ForceFeedbackMpc(), PERIOD)
    estimate, reference = next(inputs(0.0))
    q = np.round(estimate.q, 3).astype(np.float32)
    plain = replace(estimate, q=q.astype(np.float64), v=np.zeros(ROBOT.n))
    wide = np.zeros((ROBOT.n, 2))
    wide[:, 0] = plain.q
    answers = [
        controller.step(given, reference, controller.init(plain))[0].torque
        for given in (
            plain,
            replace(plain, q=wide[:, 0]),
            replace(plain, q=q, v=np.zeros(ROBOT.n, dtype=int)),
            replace(plain, q=plain.q + 1e-3),
        )
    ]
    np.testing.assert_array_equal(answers[0], answers[1])
    np.testing.assert_array_equal(answers[0], answers[2])
    assert np.abs(answers[0] - answers[3]).max() > 1e-3
