"""How long one step of the stack takes."""

from __future__ import annotations

import time
from typing import Any

import numpy as np

from pliant.controllers.presets import STIFF_STACK
from pliant.controllers.registry import build_stack
from pliant.robot import Robot
from pliant.signals import Estimate, Reference, TaskReference


def run(n: int = 20000, *, robot: str = "lwr4", read_diagnostics: bool = False) -> dict[str, Any]:
    """Times steps of the two-task stack (6 + 3 axes): kinematics, phases, forces, torques, ledger and the command.

    The joints move along a smooth path, so that phases switch as they do in use.

    Args:
        n: steps that count; a tenth more warm up first.
        robot: catalogue name, with frames `flange` and `elbow`.
        read_diagnostics: also reads every channel of every command, as a recorder would.

    Returns:
        CPU time per step in µs: {"steps", "unit", "cpu": {"median", "p90", "p99", "max"}, "wall": {...}}. Run it with
        OMP_NUM_THREADS=1 on an idle machine; the largest values are the operating system's.
    """
    arm = Robot.load(robot)
    controller = build_stack(arm, STIFF_STACK, 1e-3)
    reference = _reference(arm)
    warm_up = max(n // 10, 1)
    zero = np.zeros(arm.n)
    phase = np.arange(arm.n)
    cpu, wall = np.empty(n), np.empty(n)
    state = controller.init(Estimate(0.0, arm.home, zero, zero, zero))
    for k in range(-warm_up, n):
        t = 1e-3 * k
        estimate = Estimate(t, arm.home + 0.01 * np.sin(7.0 * t + phase), zero, zero, zero)
        wall_start, cpu_start = time.perf_counter_ns(), time.thread_time_ns()
        command, state = controller.step(estimate, reference, state)
        if read_diagnostics:
            dict(command.diagnostics)
        cpu_end, wall_end = time.thread_time_ns(), time.perf_counter_ns()
        if k >= 0:
            cpu[k], wall[k] = 1e-3 * (cpu_end - cpu_start), 1e-3 * (wall_end - wall_start)
    return {"steps": n, "unit": "µs", "cpu": _percentiles(cpu), "wall": _percentiles(wall)}


def _reference(robot: Robot) -> Reference:
    position, rotation = robot.placement(robot.home, "flange")
    elbow, _ = robot.placement(robot.home, "elbow")
    return Reference(0.0, (TaskReference("flange", position, rotation), TaskReference("elbow", elbow)))


def _percentiles(times: np.ndarray[Any, np.dtype[np.float64]]) -> dict[str, float]:
    median, p90, p99 = np.percentile(times, [50, 90, 99])
    return {"median": float(median), "p90": float(p90), "p99": float(p99), "max": float(times.max())}
