"""Computation times of the predictive controllers: per node, per iteration, per solve in a warm-started noisy loop.

Times depend on the machine, so the same run also measures a reference: one call of
`pinocchio.computeABADerivatives` from Python on the same robot.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pinocchio as pin

from pliant import _mpc
from pliant.errors import MissingExtraError
from pliant.mpc.config import Bounds, MpcConfig
from pliant.mpc.defaults import ClassicalMpc, ForceFeedbackMpc, TorqueFeedbackMpc
from pliant.mpc.noisy_loop import BenchCase, NoisyLoop
from pliant.robot import Robot, Tool
from pliant.stopwatch import Stopwatch, percentiles


def run(
    solves: int = 2000,
    *,
    pause: float = 2e-3,
    paused_solves: int = 200,
    bridge_solves: int = 100,
    growth: bool = True,
    robot: str = "iiwa14",
) -> dict[str, Any]:
    """Measures nodes and solves of the three controllers on a seven-joint arm.

    Args:
        solves: of each case, without pauses.
        pause: s of sleep before each of `paused_solves` solves more: caches are cold then, as on a busy robot.
        paused_solves: how many; 0 for none.
        bridge_solves: of the force-feedback problem by mim-solvers over the same nodes; 0, or crocoddyl missing: none.
        growth: also time how the cost grows with horizon, joints and contact dimension.
        robot: catalogue name, with a frame `flange`.

    Returns:
        {"unit": "µs", "instruction_set", "robot", "yardstick": statistics, "cases": {name: {"node", "hot", "paused"}},
        "bridge": …, "growth": …}. Statistics are {"median", "p90", "p99", "max"}; "hot" and "paused" hold "cpu",
        "wall", "per_iteration", "iterations", "kkt_reached" and "in_yardsticks" (CPU median over the yardstick's).
    """
    arm = Robot.load(robot, tool=Tool())
    yardstick = _yardstick(arm, max(solves, 100))
    cases = {case.name: _timed(case, solves, pause, paused_solves, yardstick) for case in _cases(arm)}
    result: dict[str, Any] = {
        "unit": "µs",
        "instruction_set": _mpc.instruction_set(),
        "robot": f"{arm.name}, {arm.n} joints",
        "horizon": 5,
        "dt": 3e-3,
        "tolerance": 1e-4,
        "yardstick": {"what": "pinocchio.computeABADerivatives from Python", **yardstick},
        "cases": cases,
    }
    if bridge_solves:
        result["bridge"] = _bridge(BenchCase("force feedback, 1-D", ForceFeedbackMpc(), arm), bridge_solves)
    if growth:
        result["growth"] = _growth(arm, max(solves // 10, 20))
    return result


def _cases(arm: Robot) -> list[BenchCase]:
    ff = ForceFeedbackMpc()
    spatial = ff.model_copy(update={"contact": ff.contact.model_copy(update={"dimension": 3})})
    bounded = ff.model_copy(update={"bounds": Bounds(torque=True, force_max=200.0)})
    return [
        BenchCase("force feedback, 1-D", ff, arm),
        BenchCase("force feedback, 1-D, one spot", ff, arm, press=True),
        BenchCase("force feedback, 3-D, one spot", spatial, arm, press=True),
        BenchCase("force feedback, 1-D, bounds", bounded, arm),
        BenchCase("classical", ClassicalMpc(), arm),
        BenchCase("torque feedback", TorqueFeedbackMpc(), arm),
    ]


def _timed(case: BenchCase, solves: int, pause: float, paused: int, yardstick: dict[str, float]) -> dict[str, Any]:
    loop = NoisyLoop(case)
    found: dict[str, Any] = {"node": _node_times(loop), "hot": _solve_times(loop, solves, 0.0)}
    if paused:
        found["paused"] = _solve_times(loop, paused, pause)
    for part in ("hot", "paused"):
        if part in found:
            found[part]["in_yardsticks"] = found[part]["cpu"]["median"] / yardstick["median"]
    return found


def _solve_times(loop: NoisyLoop, solves: int, pause: float) -> dict[str, Any]:
    """Times of `solves` solves, after a tenth as many for warm-up."""
    warm_up = max(solves // 10, 5)
    watch, iterations, reached = Stopwatch(), np.empty(solves), 0
    for k in range(-warm_up, solves):
        x = loop.next_state()
        loop.solver.shift()
        if pause and k >= 0:
            time.sleep(pause)
        with watch.timed(k >= 0):
            solution = loop.solver.solve(x, max_iterations=8, tolerance=1e-4)
        loop.follow(solution.xs)
        if k >= 0:
            iterations[k] = solution.iterations
            reached += solution.kkt <= 1e-4
    return {
        **watch.summary(),
        "per_iteration": percentiles(watch.cpu / np.maximum(iterations, 1)),
        "iterations": {"mean": float(iterations.mean()), "max": int(iterations.max())},
        "kkt_reached": reached / solves,
    }


def _node_times(loop: NoisyLoop, repetitions: int = 2000) -> dict[str, float]:
    """µs per evaluation of one running node, measured inside the extension."""
    node = _mpc.Node(loop.chain, loop.model, loop.config.dt)
    nodes = loop.solver.nodes
    loop.next_state()
    for name in ("state_weight", "translation_weight", "rotation_weight", "velocity_weight", "torque_gravity_weight"):
        getattr(node.parameters, name)[0] = getattr(nodes, name)[0]
    node.parameters.stiffness[0], node.parameters.damping[0] = nodes.stiffness[0], nodes.damping[0]
    u = loop.solver.us[0]
    return {
        "calc": 1e6 * min(node.benchmark(loop.x, u, repetitions, derivatives=False) for _ in range(5)),
        "calc_and_derivatives": 1e6 * min(node.benchmark(loop.x, u, repetitions) for _ in range(5)),
    }


def _bridge(case: BenchCase, solves: int) -> dict[str, Any]:
    """The same problem solved by mim-solvers over the kernel's nodes, called from Python."""
    try:
        from mim_solvers import SolverSQP

        from pliant.mpc.crocoddyl.bridge import shooting_problem
    except (ImportError, MissingExtraError):
        return {"missing": "pip install 'pliant[crocoddyl]'"}
    loop = NoisyLoop(case)
    watch, iterations = Stopwatch(), np.empty(solves)
    xs, us = loop.solver.xs, loop.solver.us
    for k in range(solves):
        x = loop.next_state()
        sqp = SolverSQP(shooting_problem(loop.problem, loop.solver.nodes, x, loop.chain))
        sqp.termination_tolerance, sqp.use_filter_line_search = 1e-4, True
        with watch.timed():
            sqp.solve([x, *xs[1:]], list(us), 8, False, loop.config.regularisation)
        iterations[k] = sqp.iter
        xs, us = np.array(sqp.xs.tolist()), np.array(sqp.us.tolist())
        loop.follow(xs)
        xs, us = np.vstack([xs[1:], xs[-1:]]), np.vstack([us[1:], us[-1:]])
    what = "mim-solvers SQP, action models in Python over the kernel's nodes"
    return {"what": what, "cpu": percentiles(watch.cpu), "iterations": {"mean": float(iterations.mean())}}


def _growth(arm: Robot, solves: int) -> dict[str, list[dict[str, float]]]:
    """CPU µs per iteration against the horizon's length, the number of joints and the contact's dimension."""
    ff = ForceFeedbackMpc()
    joints = [
        arm.with_locked(dict.fromkeys(arm.joint_names[: arm.n - n], 0.0)) if n < arm.n else arm for n in range(3, 8)
    ]
    dimensions: Sequence[Any] = (1, 3, 6)

    def point(x: float, config: MpcConfig, robot: Robot) -> dict[str, float]:
        times = _solve_times(NoisyLoop(BenchCase("", config, robot, press=True)), solves, 0.0)
        return {"x": x, "per_iteration": times["per_iteration"]["median"], "solve": times["cpu"]["median"]}

    def of_dimension(m: int) -> MpcConfig:
        moment = max(m - 3, 0)
        stiffness, damping = (1e3,) * min(m, 3) + (5.0,) * moment, (1e2,) * min(m, 3) + (0.05,) * moment
        contact = ff.contact.model_copy(update={"dimension": m, "stiffness": stiffness, "damping": damping})
        return ff.model_copy(update={"contact": contact})

    return {
        "horizon": [point(N, ff.model_copy(update={"horizon": N}), arm) for N in (5, 10, 20, 50, 100)],
        "joints": [point(robot.n, ff, robot) for robot in joints if robot.n <= arm.n],
        "contact dimension": [point(m, of_dimension(m), arm) for m in dimensions],
    }


def _yardstick(arm: Robot, calls: int) -> dict[str, float]:
    data = arm.model.createData()
    q, v, tau = arm.home, np.full(arm.n, 0.1), np.full(arm.n, 1.0)
    call: Callable[..., Any] = pin.computeABADerivatives
    watch = Stopwatch()
    for _ in range(calls):
        with watch.timed():
            call(arm.model, data, q, v, tau)
    return percentiles(watch.wall)
