"""The compiled step says what its readable twin says, on the same inputs; its state can be copied and pickled."""

from __future__ import annotations

import copy
import pickle
import threading
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from pliant import _mpc
from pliant.configuration import merged
from pliant.environment import Environment
from pliant.errors import ConfigError, PliantError, SignalError
from pliant.mpc import (
    ClassicalMpc,
    ForceFeedbackMpc,
    MpcConfig,
    MpcController,
    MpcState,
    OffsetFreeMpc,
    TorqueFeedbackMpc,
)
from pliant.signals import Command, Estimate, Preview, Reference, TaskReference
from pliant.spatial import Array, exp3
from tests.twins.mpc_step.controller import TwinController

from .problems import polishing_arm

ROBOT = polishing_arm()
PERIOD = 1e-3  # s
POSITION, ROTATION = ROBOT.placement(ROBOT.home, "tool")
Inputs = Iterator[tuple[Estimate, Reference]]

THREE = {"dimension": 3, "stiffness": (1e3, 1e3, 3e3), "damping": (10.0, 10.0, 70.0)}
LATE = {"sensing_delay": 1e-3, "computation_delay": 3e-3, "averaging": 4e-3}
CASES: dict[str, MpcConfig] = {
    "force feedback": ForceFeedbackMpc(),
    "everything on": OffsetFreeMpc(),
    "late and averaged": merged(OffsetFreeMpc(), {"compensation": LATE}),
    "classical, late": merged(ClassicalMpc(), {"compensation": {**LATE, "disturbance": True, "force_integral": 20.0}}),
    "torque feedback, late": merged(TorqueFeedbackMpc(), {"compensation": {**LATE, "disturbance": True}}),
    "feedback between solves": merged(ForceFeedbackMpc(), {"between": "riccati"}),
    "surface, feedback": merged(ForceFeedbackMpc(), {"between": "riccati", "contact": {**THREE, "axes": "surface"}}),
    "local axes": merged(OffsetFreeMpc(), {"contact": {**THREE, "axes": "local"}}),
    "sliding": merged(ForceFeedbackMpc(), {"contact": {**THREE, "friction": 0.3}}),
    "rigid, Baumgarte": merged(ClassicalMpc(), {"contact": {"baumgarte": (20.0, 10.0)}}),
    "bounds": merged(
        OffsetFreeMpc(), {"bounds": {"torque": True, "force_max": 40.0}, "compensation": {"force_shift_max": 2.0}}
    ),
    "phases by contact": merged(ForceFeedbackMpc(), {"phase_by": "contact", "posture": "start"}),
    "velocity about zero": merged(ForceFeedbackMpc(), {"task_velocity": False, "max_iterations": 1}),
}


def preview(rng: np.random.Generator, time: float, phases: tuple[str, ...], step: float, postured: bool) -> Preview:
    count = len(phases)
    times = time + step * np.arange(count)
    turns = np.array([exp3(0.02 * rng.normal(size=3)) @ ROTATION for _ in range(count)])
    return Preview(
        time=times,
        position=POSITION + 0.01 * rng.normal(size=(count, 3)),
        rotation=turns if rng.random() < 0.8 else None,
        velocity=0.1 * rng.normal(size=(count, 6)),
        wrench=np.abs(rng.normal(size=(count, 1))) * np.array([0.0, 0.0, 20.0, 0.0, 0.0, 0.0]),
        phase=phases,
        posture=ROBOT.home + 0.1 * rng.normal(size=(count, ROBOT.n)) if postured else None,
        task_rotation=np.array([exp3(0.02 * rng.normal(size=3)) for _ in range(count)]),
    )


def inputs(lead: float, ticks: int = 120, seed: int = 0) -> Inputs:
    """What a robot may tell: noise, contact that comes and goes, numbers that are none, previews of every kind."""
    rng = np.random.default_rng(seed)
    for tick in range(ticks):
        time, n = PERIOD * tick, ROBOT.n
        touching = 30 <= tick % 80 < 70
        force = np.array([0.5, -0.5, 20.0 if touching else 0.0, 0.01, 0.02, 0.0]) + 0.1 * rng.normal(size=6)
        estimate = Estimate(
            time,
            ROBOT.home + 0.01 * rng.normal(size=n),
            0.1 * rng.normal(size=n),
            20.0 * rng.normal(size=n),
            5.0 * rng.normal(size=n),
            {"tool": force},
            {"tool": touching} if tick % 11 else {},
            disturbance=2.0 * rng.normal(size=n),
            environments={"tool": Environment(1e4 * (1.0 + tick % 5), 100.0, 10.0, 10.0)} if tick > 50 else {},
        )
        if 90 <= tick < 93 or tick == 100:
            estimate = replace(estimate, **{["q", "v", "torque"][tick % 3]: np.full(n, np.nan)})
        if tick == 95:
            estimate = replace(estimate, wrenches={"tool": np.full(6, np.inf)}, disturbance=np.full(n, np.nan))
        phases = ("circle",) * 6 if touching else ("track",) * 3 + ("circle",) * 3
        first = time + lead if tick % 4 else time - 2e-3
        ahead = preview(rng, first, phases, 3e-3 if tick % 4 else 4e-3, tick % 3 > 0) if tick % 5 else None
        turned = exp3(0.05 * rng.normal(size=3)) if tick % 2 else None
        wrench = np.array([0.0, 0.0, 25.0, 0.0, 0.0, 0.0])
        task = TaskReference(
            "tool",
            POSITION + 0.01 * rng.normal(size=3),
            ROTATION if tick % 7 else None,
            wrench=wrench,
            task_rotation=turned,
        )
        other = TaskReference("flange", POSITION)
        posture = ROBOT.home if tick % 2 else None
        phase = "circle" if touching else ("track" if tick % 3 else "")
        yield estimate, Reference(time, (task, other), posture, phase, ahead)


def furthest(ours: Command, theirs: Command) -> float:
    """The largest difference of two commands, relative to numbers above one; failures and status must be equal."""
    assert set(ours.diagnostics) == set(theirs.diagnostics)
    pairs: list[tuple[Any, Any]] = [(ours.torque, theirs.torque), (ours.clamped, theirs.clamped)]
    pairs += [(value, theirs.diagnostics[name]) for name, value in ours.diagnostics.items()]
    assert all(np.shape(a) == np.shape(b) for a, b in pairs)
    return max(float(np.max(np.abs(np.subtract(a, b)) / np.maximum(1.0, np.abs(b)))) for a, b in pairs)


def torques(controller: MpcController, state: MpcState, given: Inputs) -> Array:
    return np.array([controller.step(estimate, reference, state)[0].torque for estimate, reference in given])


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


COPIES: dict[str, Callable[[Any], Any]] = {
    "copy": copy.copy,
    "deep copy": copy.deepcopy,
    "pickle": lambda state: pickle.loads(pickle.dumps(state)),
}


@pytest.mark.parametrize("name", ["late and averaged", "bounds", "surface, feedback", "torque feedback, late"])
@pytest.mark.parametrize("copied", COPIES.values(), ids=COPIES.keys())
def test_a_copy_of_a_state_goes_on_alone_bit_for_bit(name: str, copied: Callable[[Any], Any]) -> None:
    controller = MpcController(ROBOT, CASES[name], PERIOD)
    given = list(inputs(controller.delays.lead, 80))
    state = controller.init(given[0][0])
    for estimate, reference in given[:41]:  # in contact, between two solves
        _, state = controller.step(estimate, reference, state)
    forked = copied(state)
    kept = copied(state)
    first = torques(controller, state, iter(given[41:]))
    second = torques(controller, forked, iter(given[41:]))
    np.testing.assert_array_equal(first, second)
    other = torques(controller, kept, inputs(controller.delays.lead, 39, seed=1))
    assert np.abs(other - first).max() > 1e-3  # baseline: other inputs, other torques


def test_bytes_that_are_no_state_are_refused() -> None:
    controller = MpcController(ROBOT, ForceFeedbackMpc())
    whole = controller.init(next(inputs(0.0))[0]).__getstate__()
    for wrong in (b"", whole[:-8], whole + b"12345678", bytes(len(whole))):
        with pytest.raises(ValueError, match="no state of a predictive controller"):
            _mpc.ControllerState.__new__(_mpc.ControllerState).__setstate__(wrong)


def test_the_state_of_another_controller_is_refused() -> None:
    estimate, reference = next(inputs(0.0))
    late = MpcController(ROBOT, CASES["late and averaged"], PERIOD)
    plain = MpcController(ROBOT, ForceFeedbackMpc(), PERIOD)
    with pytest.raises(ValueError, match="belongs to another controller"):
        plain.step(estimate, reference, late.init(estimate))


def test_two_threads_get_what_one_gets() -> None:
    """Each with its own state of one controller; the interpreter is free while a step computes."""
    controller = MpcController(ROBOT, CASES["late and averaged"], PERIOD)
    given = list(inputs(controller.delays.lead, 100))
    alone = torques(controller, controller.init(given[0][0]), iter(given))
    found: dict[int, Array] = {}

    def work(name: int) -> None:
        found[name] = torques(controller, controller.init(given[0][0]), iter(given))

    threads = [threading.Thread(target=work, args=(name,)) for name in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for answer in found.values():
        np.testing.assert_array_equal(answer, alone)


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
