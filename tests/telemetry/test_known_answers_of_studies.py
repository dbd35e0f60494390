"""Every metric of stack, polishing and haptic against a value worked out by hand, on ten samples with unequal axes.

A metric that is added has no answer here at first: the tests that compare names fail until it has one.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest

from pliant.configuration import merged
from pliant.robot import Robot
from pliant.signals import ImpedanceTuning
from pliant.studies.haptic import STUDY as HAPTIC
from pliant.studies.haptic import measure as haptic
from pliant.studies.haptic.config import Check, HapticCaseConfig
from pliant.studies.polishing import STUDY as POLISHING
from pliant.studies.polishing.measure import measure as polishing
from pliant.studies.stack import STUDY as STACK
from pliant.studies.stack.measure import measure as stack
from tests.telemetry.ten_samples import K, columns, ten_samples

# ---------------------------------------------------------------------- stack

LIMITS = np.array([176.0, 176.0, 100.0, 100.0, 100.0, 38.0, 38.0])  # N·m, of the lwr4
STACK_ANSWERS: Mapping[str, float] = {
    # samples 4 … 9 count, from 1 s on: Σ k² = 271 over 6 samples
    "RMSE x": 1.0 * math.sqrt(271.0 / 6.0),  # mm
    "RMSE y": 2.0 * math.sqrt(271.0 / 6.0),
    "RMSE z": 3.0 * math.sqrt(271.0 / 6.0),
    "torque variation": (13.0 + 2.0) / 7.0 / 0.25,  # mean of 9, 11, 13, 15, 17 in joint 0; 2 in joint 5
    "peak torque": 81.0,
    "torque step": 100.0 * 17.0 / 176.0,  # of joint 0, not 2/38
    "joint speed at the end": 0.9,  # of the last second, samples 5 … 9
    "phase switches": 1.0 / (5.0 * 6.0) / 0.25,  # one of six axes, once in five steps
    "storage margin of translation": -0.09,
    "|h| over F_max": 0.75,
}


def _stack() -> dict[str, float]:
    changes = {"path": {"kind": "hold", "ramp": 0.0}, "duration": 2.5, "period": 0.25, "physics_step": 0.25}
    config = merged(STACK.case("calibration"), changes)
    tool, elbow = config.frames()
    robot = Robot.load("lwr4")
    np.testing.assert_array_equal(robot.torque_limit, LIMITS)
    place = columns(0.1, -0.6, 0.5)
    bounds = {
        frame: ImpedanceTuning(np.full(6, 1.0), np.array(most), np.full(6, 0.5), np.full(6, 0.1))
        for frame, most in ((tool, [10.0, 20.0, 40.0, 1.0, 2.0, 4.0]), (elbow, [4.0, 8.0, 16.0, 1.0, 1.0, 1.0]))
    }
    margin = columns(-0.01 * K, 0.0, 0.02 * K, -K, -K, -K)  # rotation does not count
    log = ten_samples(
        0.25,
        7,
        {tool: place + 1e-3 * columns(K, -2.0 * K, 3.0 * K), elbow: place},
        {tool: place, elbow: place},
        torque=columns(K**2, 0, 0, 0, 0, -2.0 * K, 0),
        v=columns(0.0, -0.1 * K, 0, 0, 0, 0, np.where(K == 2, 5.0, 0.0)),
        tuning=bounds,
        command={
            "ee/phase": columns(0, 0, 0, 0, 0, K > 6),
            "ee/storage_margin": margin,
            "ee/force": columns(-0.5 * K, 0, 0, 0, 0, 0),  # at most 4.5/10
            "elbow/force": columns(0, -6.0, 0, 0, 0, 0),  # 6/8
        },
    )
    return {metric.name: metric.value for metric in stack(config, robot, log)}


# ---------------------------------------------------------------------- polishing

TILT = 0.1  # rad
POLISHING_ANSWERS: Mapping[str, float] = {
    # the circle from sample 6 on: 6 … 9, Σ k = 30; the ramp ends at sample 4
    "E_λ": 7.5,  # k
    "E_P": (7.5 + 15.0) / 2.0,  # mm: k along x, −2 k along y
    "E_τ": (7.5 + 0.5 * 7.5) / 6.0,  # N·m: two of six joints
    "E_τ averaged over 21 ms": (7.5 + 0.5 * 7.5) / 6.0,  # the same: both grow along straight lines
    "λ_max": 59.0,
    "λ_dev": 9.0,
    "t_break": 100.0 / 6.0,  # one of samples 4 … 9
    "first contact peak": 21.0,  # the spike in sample 3; the 70 N of sample 1 came before the descent
    "E_λ along the normal": 0.0,
    "E_P in the table's plane": 0.0,
    "E_λ as the authors filter": 0.0,
    "KKT reached": 70.0,
    "iterations": 4.5,
}


def _polishing() -> tuple[dict[str, float], dict[str, float]]:
    """What is measured, and what the three metrics on tilted or filtered signals should be."""
    task = {"start": 0.1, "reach": 0.2, "touch": 0.3, "pressed": 0.4, "circle": 0.6}
    changes = {"task": task, "table": {"tilt": TILT}, "duration": 1.0, "period": 0.1, "physics_step": 0.1}
    config = merged(POLISHING.case("ideal"), changes)
    place = columns(0.65, 0.0, 0.025)
    normal = np.array([0, 70.0, 0, 21.0, 40.0, 0.0, 56.0, 57.0, 58.0, 59.0])  # N
    force = columns(2.0, 5.0, normal, 0, 0, 0)
    believed = columns(0, 0, np.where(K > 5, normal + 1.0, normal), 0, 0, 0)
    log = ten_samples(
        0.1,
        6,
        {"tool": place + 1e-3 * columns(K, -2.0 * K, 4.0 * K)},
        {"tool": place},
        torque=columns(0, 0, 3.0, 0, 0, 0),
        acting=columns(K, 0, 3.0 - 0.5 * K, 0, 0, 0),
        felt={"tool": force},
        believed={"tool": believed},
        asked={"tool": columns(0, 0, 50.0, 0, 0, 0)},
        command={"mpc/status": np.where(K < 7, 0.0, 1.0), "mpc/iterations": K},
    )
    found = {metric.name: metric.value for metric in polishing(config, log)}
    c, s = math.cos(TILT), math.sin(TILT)
    off = [abs(-5.0 * s + c * f - 50.0) for f in (56.0, 57.0, 58.0, 59.0)]
    plane = [(k + abs(-2.0 * k * c + 4.0 * k * s)) / 2.0 for k in (6, 7, 8, 9)]
    smooth = [  # a window of 21 shrinks to what there is on both sides: samples 3 … 9, 5 … 9, 7 … 9, 9
        (21.0 + 40.0 + 0.0 + 57.0 + 58.0 + 59.0 + 60.0) / 7.0,
        (0.0 + 57.0 + 58.0 + 59.0 + 60.0) / 5.0,
        (58.0 + 59.0 + 60.0) / 3.0,
        60.0,
    ]
    return found, {
        "E_λ along the normal": sum(off) / 4.0,
        "E_P in the table's plane": sum(plane) / 4.0,
        "E_λ as the authors filter": sum(abs(value - 50.0) for value in smooth) / 4.0,
    }


# ---------------------------------------------------------------------- haptic

CHECKS: Mapping[str, tuple[Mapping[str, Any], float]] = {
    # kind → the check's other values, the answer; samples 2 … 9 count, 0.2 s … 1 s
    "rms": ({"wanted": 40.0}, math.sqrt((4.0 + 9.0 + 16.0 + 25.0 + 36.0 + 49.0 + 64.0 + 81.0) / 8.0)),
    "max": ({"wanted": 40.0, "relative": True}, 9.0 / 40.0),
    "settle": ({"wanted": 49.0, "before": 39.0}, 0.7),  # within 0.5 N of 49 in the last sample only
    "breaks": ({"wanted": -5.0, "axis": 0}, 1.0),
    "peak": ({}, math.sqrt(4.0**2 + 3.0**2 + 49.0**2)),
    "lateral": ({}, 18.0),  # mm across z: k along x, −2 k along y
    "return": ({}, 36.0),  # mm: 4 k along z
    "offset": ({}, 9.0),  # mm
    "off-bound": ({"axis": 1}, 25.0 - 2.0),  # mm, of the sample with the least offset
    "beyond-bound": ({}, 9.0 - 8.0),  # mm: |Δx_z| over its bound of 8 mm
    "unreachable": ({"axis": 1}, 3.0 / 8.0),  # share of the time
    "tilt": ({}, 90.0 - math.degrees(1.4)),
    "speed": ({}, 1e-3 * math.sqrt(1.0 + 4.0 + 16.0) / 0.1),  # m/s: (1, −2, 4) mm a period
    "over": ({"axis": 2}, 9.0),  # N over 40
    "link": ({}, 13.0),  # N: 5 and 12
    "knee": ({}, math.degrees(0.2)),
    "reachable": ({"wanted": 30.0, "axis": 0}, 7.0),
    "share": ({}, 0.6),
}


def _haptic(kind: str) -> float:
    own, _ = CHECKS[kind]
    check = Check(kind=kind, name="x", begin=0.2, **own)  # pyright: ignore[reportArgumentType]
    config: HapticCaseConfig = HAPTIC.case("box-top").model_copy(update={"period": 0.1, "checks": (check,)})
    place = columns(0.1, 0.2, 0.3)
    side = np.where((K == 4) | (K < 2), 0.0, -4.0)  # lost once, in sample 4
    turned = np.array([0.3, 0.0, 0.1, math.cos(0.7), 0.6 * math.sin(0.7), 0.8 * math.sin(0.7), 0.0])  # by 1.4 rad
    tuning = ImpedanceTuning(np.full(3, 1e3), np.array([5.0, 10.0, 50.0]), np.array([0.03, 0.02, 0.008]))
    log = ten_samples(
        0.1,
        3,
        {"foot": place + 1e-3 * columns(K, -2.0 * K, 4.0 * K)},
        {"foot": place},
        q=columns(1.0, 2.0, np.where(K == 1, 0.0, -0.1 * K)),
        felt={
            "foot": columns(side, 3.0, 40.0 + K, 0, 0, 0),
            "shank": columns(0, 5.0, np.where(K == 3, -12.0, 0.0), 0, 0, 0),
        },
        asked={"foot": columns(0, 0, 40.0, 0, 0, 0)},
        tuning={"foot": tuning},
        objects={"box": np.tile(turned, (10, 1))},
        command={"foot/force": columns(0, np.where(K == 5, -6.0, 0.0), 25.0)},
        reference={
            "exploration/foot/offset": 1e-3 * columns(0, np.where(K == 0, 9.0, 2.0), -K),
            "exploration/foot/unreachable": columns(0, K > 6, 1.0),
            "exploration/foot/reachable": columns(37.0, 0, 99.0),
        },
    )
    (metric,) = haptic.measure(config, log)
    return metric.value


def test_every_kind_of_check_has_a_known_answer() -> None:
    assert set(haptic._KINDS) == set(CHECKS)


@pytest.mark.parametrize("kind", CHECKS)
def test_check_of_the_haptic_study(kind: str) -> None:
    assert _haptic(kind) == pytest.approx(CHECKS[kind][1], rel=1e-9)


def test_metrics_of_the_stack() -> None:
    found = _stack()
    assert set(found) == set(STACK_ANSWERS)
    assert found == pytest.approx(STACK_ANSWERS, rel=1e-9)


def test_metrics_of_polishing() -> None:
    found, tilted = _polishing()
    answers = {**POLISHING_ANSWERS, **tilted}
    assert set(found) == set(answers)
    assert found == pytest.approx(answers, rel=1e-9)
