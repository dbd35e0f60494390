"""References along the horizon: each node at its own time."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from pliant.errors import ConfigError, SignalError
from pliant.mpc.horizon import HorizonReference
from pliant.signals import Preview, Reference, TaskReference
from tests.twins.mpc_step.horizon import along_horizon, require_pushing


def _preview(step: float, count: int) -> Preview:
    times = 1.0 + step * np.arange(count)
    return Preview(
        time=times,
        position=np.outer(times, [1.0, 2.0, 3.0]),
        rotation=np.tile(np.eye(3), (count, 1, 1)),
        velocity=np.tile([1.0, 2.0, 3.0, 0.0, 0.0, 0.0], (count, 1)),
        wrench=np.outer(times, [0.0, 0.0, 10.0, 0.0, 0.0, 0.0]),
        phase=tuple("before" if t < 1.0055 else "after" for t in times),
    )


@pytest.mark.parametrize(("step", "count"), [(0.003, 6), (0.001, 30), (0.0075, 4)])
def test_each_node_has_the_reference_and_the_phase_of_its_own_time(step: float, count: int) -> None:
    found = along_horizon(Reference(1.0, preview=_preview(step, count)), "tool", 5, 0.003)
    times = 1.0 + 0.003 * np.arange(6)
    np.testing.assert_allclose(found.position, np.outer(times, [1.0, 2.0, 3.0]))
    np.testing.assert_allclose(found.wrench[:, 2], 10.0 * times)
    if step <= 0.003:
        assert found.phase == ("before", "before", "after", "after", "after", "after")


def test_a_switch_rolls_through_the_horizon_node_by_node() -> None:
    preview = _preview(0.001, 60)
    counts = []
    for tick in range(20):
        reference = Reference(1.0 + 0.001 * tick, preview=preview)
        counts.append(along_horizon(reference, "tool", 5, 0.003).phase.count("after"))
    assert counts[0] == 4
    assert counts[-1] == 6
    assert all(0 <= after - before <= 1 for before, after in itertools.pairwise(counts))


def test_without_a_preview_the_task_goes_on() -> None:
    task = TaskReference("tool", np.array([0.1, 0.0, 0.5]), velocity=np.array([0.3, 0, 0, 0, 0, 0]))
    found = along_horizon(Reference(2.0, (task,), phase="press"), "tool", 4, 0.01)
    np.testing.assert_allclose(found.position[:, 0], 0.1 + 0.3 * 0.01 * np.arange(5))
    assert found.phase == ("press",) * 5
    assert found.rotation is None
    with pytest.raises(SignalError, match=r"a task for frame 'flange', it has \['tool'\]"):
        along_horizon(Reference(2.0, (task,)), "flange", 4, 0.01)


def test_a_reference_that_is_not_finite_is_refused() -> None:
    task = TaskReference("tool", np.array([np.nan, 0.0, 0.5]))
    with pytest.raises(SignalError, match="must be finite"):
        along_horizon(Reference(0.0, (task,)), "tool", 2, 0.01)


@pytest.mark.parametrize("normal", [(0.0, 0.0, 1.0), (0.0, -1.0, 0.0)])
def test_a_force_that_pulls_on_the_surface_is_refused(normal: tuple[float, float, float]) -> None:
    n = np.array(normal)

    def horizon(force: float, node: int) -> HorizonReference:
        wrench = np.tile(np.append(20.0 * n, np.zeros(3)), (4, 1))
        wrench[node, :3] = force * n
        zero = np.zeros((4, 3))
        return HorizonReference(zero, None, np.zeros((4, 6)), wrench, None, ("press",) * 4)

    require_pushing(horizon(0.0, 2), n)
    require_pushing(horizon(20.0, 2), np.tile(n, (4, 1)))
    for normals in (n, np.tile(n, (4, 1))):
        with pytest.raises(ConfigError, match=r"a desired force of -5 N along the surface's outward normal .* pulls"):
            require_pushing(horizon(-5.0, 3), normals)
