"""What [FFMPC] says beside its tables, as rows: ten circles, stop, overshoot, drives, sensors that differ, V-B."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from pliant.experiments.case import Case, Changes, PaperTable, Row, once
from pliant.overlay import overlaid
from pliant.studies.polishing.cases_sweeps import force_weight
from pliant.studies.polishing.config import PolishingConfig
from pliant.studies.polishing.rows import (
    ALL,
    ROWS,
    STOCK,
    WITHOUT_LOOP,
    case_config,
    delayed,
    imperfect,
    tilted,
    varied,
)

_FORCE, _TORQUE, _NAIVE = "force-feedback-mpc", "torque-feedback-mpc", "visco-elastic-mpc"
_TILTED = {"tilt": math.radians(6.0)}
_CIRCLES: Mapping[str, tuple[Mapping[str, Any], Mapping[str, tuple[float, float, float]]]] = {
    "Table V": (
        {"duration": 24.5},
        {
            "E_λ of a circle": (9.31, 4.28, 1.70),
            "E_λ from circle to circle": (0.79, 0.63, 0.15),
            "E_P of a circle": (6.48, 3.23, 3.10),
            "E_P from circle to circle": (0.21, 0.12, 0.11),
        },
    ),
    "Table VI": (
        {"duration": 24.5, "table": _TILTED},
        {
            "E_λ of a circle": (9.49, 9.67, 2.12),
            "E_λ from circle to circle": (1.59, 0.61, 0.37),
            "E_P of a circle": (7.04, 3.37, 3.34),
            "E_P from circle to circle": (0.43, 0.28, 0.11),
        },
    ),
    "Table VII": (
        {"duration": 14.0, "table": _TILTED, "task": {"speed": 6.0}},
        {
            "E_λ of a circle": (9.00, 11.40, 1.84),
            "E_λ from circle to circle": (1.61, 1.45, 0.32),
            "E_P of a circle": (10.85, 5.41, 5.29),
            "E_P from circle to circle": (0.12, 0.12, 0.03),
        },
    ),
}
"""table → what it changes, and its numbers: mean and standard deviation over ten circles on the paper's robot"""
_HEADINGS = {
    "E_P of a circle": "E_P of a circle, mm",
    "E_P from circle to circle": "its deviation, mm",
    "E_λ of a circle": "E_λ of a circle, N",
    "E_λ from circle to circle": "its deviation, N",
}


def _ten_circles(label: str, controller: str) -> Row:
    changes, table = _CIRCLES[label]
    paper = {name: numbers[STOCK.index(controller)] for name, numbers in table.items()} if controller in STOCK else {}
    return Row(label, controller, {**delayed(controller), **changes}, paper=paper)


_QUIET = {"imperfections": {"sensing": {"noise_q": 0.0, "noise_v": 0.0, "noise_torque": 0.0, "noise_force": 0.0}}}
_AUTHORS = {"imperfections": {"actuation": {"bias": (2.0, 2.0)}, "sensing": {"delay": 0.0}}}
_DRIVES: Mapping[str, Changes] = {"as printed": {}, "without noise": _QUIET, "bias +2 N·m, δ_s = 0": _AUTHORS}
_LOOPS: Mapping[str, Changes] = {"PID": {}, "no PID": WITHOUT_LOOP}
_MISMATCH = {"imperfections": {"sensing": {"torque_gain_error": 0.1, "torque_offset": 2.0}}}
_MODEL = {"estimation": {"torque": "model"}}
_SENSORS: Mapping[str, Changes] = {
    "sensors agree": {},
    "sensors agree, τ̂ of eq. 37": _MODEL,
    "sensors differ": _MISMATCH,
    "sensors differ, τ̂ of eq. 37": {**_MISMATCH, **_MODEL},
}
_PERFECT_AND_NOT: Mapping[str, Changes] = {
    "K known": {},
    "table 0.5 mm lower": {"table": {"height_error": 5e-4}},
    "table tilted by 6°": {"table": _TILTED},
    "K believed 3e3": {"control": {"contact": {"stiffness": (3e3,)}}},
}
_BOTH = tilted((-6.0, 6.0), 1)

OPEN_CASES: tuple[Case[PolishingConfig], ...] = (
    Case(
        case_config("ten-circles", **imperfect()),
        [_ten_circles(label, name) for label in _CIRCLES for name in ALL],
        once,
        tables=[PaperTable(f"{label} (the paper's numbers: on its robot)", _HEADINGS, label) for label in _CIRCLES],
    ),
    Case(
        case_config("stop", duration=8.0, task={"stop": 6.0}, **imperfect()),
        [Row("", name, delayed(name)) for name in ALL],
        once,
    ),
    Case(
        case_config("overshoot", duration=8.0, task={"pattern": "square"}, **imperfect()),
        [force_weight(_FORCE, factor) for factor in (3.0, 1.0, 0.3, 0.1, 0.03)],
        once,
    ),
    Case(
        case_config("torque-loop", **imperfect()),
        [
            varied(name, f"{drives}, {loop}", overlaid(None, changes, without))
            for name in STOCK
            for drives, changes in _DRIVES.items()
            for loop, without in _LOOPS.items()
        ],
        _BOTH,
    ),
    Case(
        case_config("sensor-mismatch", controller=_TORQUE, task={"speed": 6.0}, **imperfect()),
        [
            varied(name, f"{label}, {loop}", overlaid(None, changes, without))
            for name in (_TORQUE, STOCK[0], _FORCE)
            for label, changes in _SENSORS.items()
            for loop, without in _LOOPS.items()
            if name == _TORQUE or not changes.get("estimation")  # the others read no joint torque
        ],
        _BOTH,
        figures=[ROWS],
    ),
    Case(
        case_config("naive", controller=_NAIVE, **imperfect()),
        [varied(_NAIVE, label, changes) for label, changes in _PERFECT_AND_NOT.items()]
        + [varied(_FORCE, label, changes) for label, changes in _PERFECT_AND_NOT.items() if label.startswith("table")],
        once,
        figures=[ROWS],
    ),
)
