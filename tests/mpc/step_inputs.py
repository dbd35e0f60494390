"""Configurations of the predictive controllers, and random inputs with which their steps are compared."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from pliant.configuration import merged
from pliant.environment import Environment
from pliant.mpc import (
    ClassicalMpc,
    ForceFeedbackMpc,
    MpcConfig,
    MpcController,
    MpcState,
    OffsetFreeMpc,
    TorqueFeedbackMpc,
)
from pliant.signals import Estimate, Preview, Reference, TaskReference
from pliant.spatial import Array, exp3

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
    "late and averaged": merged(OffsetFreeMpc(), {"compensation": {**LATE, "environment_damping": True}}),
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


def _environment(tick: int) -> Environment:
    """Well known and not, stiff and soft, more and less damped."""
    return Environment(1e4 * (1.0 + tick % 5), 150.0 + 40.0 * (tick % 3), 10.0, 10.0 if tick % 4 else 60.0)


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
            environments={"tool": _environment(tick)} if tick > 50 and tick % 13 else {},
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


def torques(controller: MpcController, state: MpcState, given: Inputs) -> Array:
    return np.array([controller.step(estimate, reference, state)[0].torque for estimate, reference in given])
