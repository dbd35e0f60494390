"""How long one step of the haptic controller takes: planner, exploration, impedance and torque map."""

from __future__ import annotations

from typing import Any

import numpy as np

from pliant.signals import Estimate
from pliant.stopwatch import Stopwatch
from pliant.studies.haptic.build import planned, robot_of
from pliant.studies.haptic.cases import CASES

_STIFFNESS = 6000.0  # N/m of the synthetic contact


def run(n: int = 20000) -> dict[str, Any]:
    """Times steps of the floor case's controller against a synthetic contact, so that nothing else is timed.

    The foot presses throughout and its targets move it to and fro, so that planner, exploration and phases work as
    they do in use.

    Args:
        n: steps that count; a tenth more warm up first.

    Returns:
        CPU and wall time per step in µs: {"steps", "unit", "cpu": {"median", "p90", "p99", "max"}, "wall": {...}}. Run
        it with OMP_NUM_THREADS=1 on an idle machine.
    """
    config = CASES["floor"].config
    config = config.model_copy(update={"steps": _to_and_fro(n * config.period)})
    robot = robot_of(config)
    entry, parameters = config.entry, config.controller_parameters(robot)
    source = entry.filter(planned(config, robot, parameters), robot, parameters)
    controller = entry.build(robot, parameters, config.period)
    zero, warm_up = np.zeros(robot.n), max(n // 10, 1)
    first = Estimate(-warm_up * config.period, robot.home, zero, zero, zero, {config.frame: np.zeros(6)})
    ref, ctl = source.init(first), controller.init(first)
    watch = Stopwatch()
    offset = 0.0
    for k in range(-warm_up, n):
        t = config.period * k
        force = np.array([0.0, 0.0, max(20.0 - _STIFFNESS * offset + np.sin(300.0 * t), 0.0), 0.0, 0.0, 0.0])
        q = robot.home + 0.002 * np.sin(7.0 * t + np.arange(robot.n))
        estimate = Estimate(t, q, zero, zero, zero, {config.frame: force})
        with watch.timed(k >= 0):
            reference, ref = source.step(estimate, ref)
            _, ctl = controller.step(estimate, reference, ctl)
        offset = float(np.asarray(reference.diagnostics.get(f"exploration/{config.frame}/offset", np.zeros(3)))[2])
    return {"steps": n, "unit": "µs", **watch.summary()}


def _to_and_fro(duration: float) -> tuple[Any, ...]:
    """The floor case's first step, then a target and a force that change twice a second."""
    first = CASES["floor"].config.steps[0]
    later = [
        first.model_copy(
            update={"time": 0.5 * i, "target": (0.05 + 0.1 * (i % 2), 0.0, 0.017), "force": (0.0, 0.0, 30.0 + i % 3)}
        )
        for i in range(1, int(2.0 * duration) + 2)
    ]
    return first, *later
