"""The compiled bound on torque steps against its twin, tick by tick."""

from __future__ import annotations

import numpy as np
import pytest

from pliant import _guard
from tests.twins.step_limit_twin import BoundTorques, bound_step

N = 5
STEP_MAX = np.array([1.0, 2.0, 0.5, np.inf, 3.0])  # N·m


@pytest.mark.parametrize("spendable", [None, 0.0, 2e-3, 1.0])
def test_it_equals_its_twin(spendable: float | None) -> None:
    rng = np.random.default_rng(4)
    core = _guard.StepLimit(STEP_MAX.tolist())
    channels = {} if spendable is None else {"spendable": spendable}
    q = rng.normal(size=N)
    last = BoundTorques(q, np.zeros(N), np.zeros(N), 0.0)
    memory, out = np.concatenate([q, np.zeros(2 * N + 1)]), np.empty(2 * N)
    held, gave_way = 0, 0
    for tick in range(400):
        q = q + 1e-3 * rng.normal(size=N)
        wanted, clamped = last.sent + (0.3 if tick % 3 else 3.0) * rng.normal(size=N), rng.normal(size=N)
        exceeded = core.step(wanted, clamped, q, channels, "spendable", None, memory, out)
        last = bound_step(last, wanted, q, STEP_MAX, np.inf if spendable is None else spendable)
        np.testing.assert_allclose(out, [*last.sent, *(clamped + last.held_back)], rtol=0.0, atol=1e-10)
        np.testing.assert_allclose(memory, [*q, *last.sent, *last.held_back, last.energy], rtol=0.0, atol=1e-10)
        assert (exceeded is None) == (last.exceeded is None)
        held += exceeded is not None
        gave_way += bool(exceeded)
        if exceeded is not None:
            assert exceeded == pytest.approx(last.exceeded, abs=1e-10)
    assert 0 < held < 400
    assert (gave_way > 0) == (spendable in (0.0, 2e-3))


def test_sizes_are_checked() -> None:
    core = _guard.StepLimit(STEP_MAX.tolist())
    zero, memory, out = np.zeros(N), np.zeros(core.memory_size), np.empty(2 * N)
    assert core.step(zero, zero, zero, {}, "", None, memory, out) is None  # baseline
    for name, inputs in {
        "torque": (np.zeros(4), zero, zero, memory, out),
        "clamped": (zero, np.zeros(4), zero, memory, out),
        "q": (zero, zero, np.zeros(6), memory, out),
        "memory": (zero, zero, zero, np.zeros(3), out),
        "out": (zero, zero, zero, memory, np.empty(N)),
    }.items():
        torque, clamped, q, kept, into = inputs
        with pytest.raises(ValueError, match=name):
            core.step(torque, clamped, q, {}, "", None, kept, into)


def test_channels_in_a_row_are_kept_with_those_of_the_bound() -> None:
    rng = np.random.default_rng(5)
    core, given = _guard.StepLimit(STEP_MAX.tolist()), rng.normal(size=4)
    memory = np.zeros(core.memory_size)
    other, plain, out = memory.copy(), np.empty(2 * N), np.empty(2 * N + 6)
    for _ in range(20):
        q, wanted = 0.1 * rng.normal(size=N), 5.0 * rng.normal(size=N)
        inputs = (wanted, np.zeros(N), q, {"spendable": 0.0}, "spendable")
        exceeded = core.step(*inputs, None, other, plain)
        assert core.step(*inputs, given, memory, out) == exceeded
        assert out.tolist() == [*plain, *given, memory[-1], exceeded or 0.0]
    with pytest.raises(ValueError, match="out"):
        core.step(*inputs, given, memory, plain)
