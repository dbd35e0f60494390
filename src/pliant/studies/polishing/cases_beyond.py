"""Beyond the paper: each part of the offset-free controller taken away, and what its tuning was not made for."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from pliant.experiments.case import Case, Changes, Row
from pliant.mpc.defaults import OffsetFreeMpc
from pliant.overlay import overlaid
from pliant.simulation import Imperfections
from pliant.studies.polishing.config import PolishingConfig
from pliant.studies.polishing.rows import (
    ALL,
    BEST,
    DELAY,
    ROWS,
    STOCK,
    SWEPT,
    WITHOUT_LOOP,
    case_config,
    imperfect,
    varied,
)

_EVERYTHING = {"control": {"compensation": OffsetFreeMpc().compensation.model_dump()}}
_THREE_D = {
    "contact": {
        "dimension": 3,
        "integrator": "euler",
        "stiffness": [3e3, 3e3, 1e4],
        "damping": [35.0, 35.0, 100.0],
        "friction": 0.25,
    },
    "costs": {"force": {"activation": [0.0, 0.0, 1.0]}, "force_rate": {"activation": [0.0, 0.0, 1.0]}},
}


def _without(**changes: Any) -> Changes:
    return {"control": {"compensation": changes}}


_PARTS: Mapping[str, Changes] = {
    "all": {},
    "no joint state filter": {"estimation": {"joint_memory": 0.0}},
    "no disturbance": _without(disturbance=False),
    "no delay prediction": _without(sensing_delay=0.0, computation_delay=0.0),
    "no averaging": _without(averaging=0.0),
    "no force integral": _without(force_integral=0.0),
    "K not estimated": _without(environment=False),
    "with bounds": {"control": {"bounds": {"torque": True, "force_max": 80.0}}},
    "3-D with friction": {"control": _THREE_D},
}
_GIVEN: Mapping[str, Changes] = {
    "stock": {},
    "joint state filter": {"estimation": {"joint_memory": 0.3}},
    "everything": _EVERYTHING,
}
_ABLATED = [
    *((BEST, label, changes) for label, changes in _PARTS.items()),
    *((name, label, changes) for name in STOCK for label, changes in _GIVEN.items()),
]
_LOOPS: Mapping[str, Changes] = {"PID": {}, "no PID": WITHOUT_LOOP}

_SENSING = Imperfections.p3().sensing
_LOUDER = {
    "noise_q": 3e-3,
    "noise_v": 3e-3,
    "noise_force": 3.0 * _SENSING.noise_force,
    "noise_torque": (0.09, 0.09, 0.06, 0.06, 0.03, 0.03),
}


def _robust(label: str, changes: Changes, **targets: float) -> Row:
    named = {"force": "E_λ", "position": "E_P"}
    return varied(BEST, label, changes, targets={named[key]: bound for key, bound in targets.items()})


BEYOND_CASES: tuple[Case[PolishingConfig], ...] = (
    Case(
        case_config("ablation", controller=BEST, **imperfect(delay=DELAY)),
        [
            Row(f"{label}, {loop}", name, overlaid(None, drives, changes))
            for loop, drives in _LOOPS.items()
            for name, label, changes in _ABLATED
        ],
        SWEPT,
        figures=[ROWS],
    ),
    Case(
        case_config("robustness", controller=BEST, **imperfect(pid=False, delay=DELAY)),
        [
            _robust("as tuned", {}),
            _robust("friction 0.5", {"table": {"friction": 0.5}}, force=1.3, position=1.2),
            _robust("6 rad/s", {"task": {"speed": 6.0}}, force=1.3, position=1.2),
            _robust("tool 0.5 kg heavier", {"unknown_mass": 0.5}, force=0.8),
            _robust("noise × 3", {"imperfections": {"sensing": _LOUDER}}, force=1.5),
            _robust("pushed", {"pushes": {"force": 20.0 * math.sqrt(2.0)}}, force=1.6),
            _robust("δ_o taken 1 ms too long", {"delay_error": 1e-3}),
            _robust("δ_o taken 1 ms too short", {"delay_error": -1e-3}),
            *(
                _robust(f"table {text} N/m", {"table": {"stiffness": float(text)}}, force=1.5)
                for text in ("3e3", "3e4", "1e5")
            ),
        ],
        SWEPT,
        figures=[ROWS],
    ),
    Case(
        case_config("wrong-masses", controller=BEST, **imperfect(delay=DELAY)),
        [varied(name, "masses ± 20 %", {"model_mass_error": 0.2}) for name in (*ALL, "visco-elastic-mpc")],
        SWEPT,
    ),
)
