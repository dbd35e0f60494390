"""How long one step of the stack takes."""

from __future__ import annotations

from typing import Any

import numpy as np

from pliant.controllers.presets import STIFF_STACK
from pliant.controllers.registry import build_stack
from pliant.robot import Robot
from pliant.signals import Estimate, Reference, TaskReference
from pliant.stopwatch import Stopwatch


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
    watch = Stopwatch()
    state = controller.init(Estimate(0.0, arm.home, zero, zero, zero))
    for k in range(-warm_up, n):
        t = 1e-3 * k
        estimate = Estimate(t, arm.home + 0.01 * np.sin(7.0 * t + phase), zero, zero, zero)
        with watch.timed(k >= 0):
            command, state = controller.step(estimate, reference, state)
            if read_diagnostics:
                dict(command.diagnostics)
    return {"steps": n, "unit": "µs", **watch.summary()}


def _reference(robot: Robot) -> Reference:
    position, rotation = robot.placement(robot.home, "flange")
    elbow, _ = robot.placement(robot.home, "elbow")
    return Reference(0.0, (TaskReference("flange", position, rotation), TaskReference("elbow", elbow)))
