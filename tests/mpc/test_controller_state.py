"""The state of a predictive controller can be copied, pickled and used by threads, and belongs to its controller."""

from __future__ import annotations

import copy
import pickle
import threading
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from pliant import _mpc
from pliant.mpc import ForceFeedbackMpc, MpcController
from pliant.spatial import Array

from .step_inputs import CASES, PERIOD, ROBOT, inputs, torques

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
