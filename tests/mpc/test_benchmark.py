"""The benchmark measures what it says; no test here asserts a time."""

from __future__ import annotations

import json

import numpy as np
import pytest

from pliant.mpc import ForceFeedbackMpc
from pliant.mpc.benchmark import run
from pliant.mpc.noisy_loop import BenchCase, NoisyLoop
from pliant.robot import Robot, Tool
from pliant.stopwatch import percentiles


def test_results_are_complete_and_plain() -> None:
    result = run(20, paused_solves=3, bridge_solves=2, pause=1e-4)
    assert json.loads(json.dumps(result)) == result
    assert result["instruction_set"] in ("sse2", "neon", "avx2", "avx512")
    for case in result["cases"].values():
        assert case["hot"]["kkt_reached"] == 1.0
        for part in ("hot", "paused"):
            cpu = case[part]["cpu"]
            assert 0.0 < cpu["median"] <= cpu["p90"] <= cpu["p99"] <= cpu["max"]
            expected = cpu["median"] / result["yardstick"]["median"]
            assert case[part]["in_yardsticks"] == pytest.approx(expected)
    assert [point["x"] for point in result["growth"]["horizon"]] == [5, 10, 20, 50, 100]
    assert [point["x"] for point in result["growth"]["joints"]] == [3, 4, 5, 6, 7]
    assert [point["x"] for point in result["growth"]["contact dimension"]] == [1, 3, 6]


def test_the_loop_is_noisy_and_goes_round() -> None:
    """What is timed is the task: states differ by the noise, and the robot follows the circle."""
    loop = NoisyLoop(BenchCase("", ForceFeedbackMpc(), Robot.load("iiwa14", tool=Tool())))
    deviation, places = [], []
    for _ in range(1050):  # 2.1 s: one turn at 3 rad/s
        x = loop.next_state()
        deviation.append(x[:7] - loop.x[:7])
        loop.solver.shift()
        solution = loop.solver.solve(x, max_iterations=8, tolerance=1e-4)
        assert solution.status == "converged"
        loop.follow(solution.xs)
        places.append(loop.chain.tool_placement(loop.x[:7])[1])
    assert np.std(deviation) == pytest.approx(1e-3, rel=0.05)
    width = np.ptp(np.array(places), axis=0)
    np.testing.assert_allclose(width[:2], 0.14, atol=0.02)  # m, the diameter of the circle


def test_statistics_are_percentiles() -> None:
    assert percentiles(np.arange(101.0)) == {"median": 50.0, "p90": 90.0, "p99": 99.0, "max": 100.0}
