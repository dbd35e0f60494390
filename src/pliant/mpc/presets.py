"""Weights of each controller: for a perfect robot, for the imperfect one, and as the paper's authors chose them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

_COSTS = {"posture": {"weight": 0.002}, "torque": {"weight": 1e-5}}
_PLANE = {"translation": {"weight": 50.0, "activation": (1.0, 1.0, 0.0)}}
_PHASES = {"ramp": _PLANE, "contact": _PLANE, "circle": {"translation": {"weight": 2000.0}}}

_PERFECT: Mapping[str, Mapping[str, Any]] = {
    "force-feedback-mpc": {
        "contact": {"stiffness": (3e3,), "damping": (70.0,)},
        "costs": {**_COSTS, "force": {"weight": 0.1, "terminal": 0.5}},
        "phases": _PHASES,
    },
    "torque-feedback-mpc": {"costs": _COSTS, "phases": _PHASES},
    "classical-mpc": {"costs": _COSTS, "phases": _PHASES},
}

_RIGID: Mapping[str, Any] = {
    "costs": {
        "posture": {"weight": 0.00037},
        "torque": {"weight": 1.1e-06},
        "rotation": {"weight": 93.0},
        "velocity": {"weight": 0.18},
    },
    "phases": {"ramp": _PLANE, "contact": _PLANE, "circle": {"translation": {"weight": 2200.0}}},
}
"""the best trial of both rigid models was the same"""

_TUNED: Mapping[str, Mapping[str, Any]] = {
    "force-feedback-mpc": {
        "contact": {"stiffness": (3e3,), "damping": (70.0,)},
        "costs": {
            "posture": {"weight": 0.014},
            "torque": {"weight": 6.9e-05},
            "rotation": {"weight": 34.0},
            "velocity": {"weight": 0.39},
            "force": {"weight": 0.012, "terminal": 0.06},
            "force_rate": {"weight": 4.5e-07},
        },
        "phases": {"ramp": _PLANE, "contact": _PLANE, "circle": {"translation": {"weight": 690.0}}},
    },
    "torque-feedback-mpc": _RIGID,
    "classical-mpc": _RIGID,
    "offset-free-mpc": {
        "costs": {
            "posture": {"weight": 0.01},
            "torque": {"weight": 6.3e-06},
            "rotation": {"weight": 22.0},
            "velocity": {"weight": 0.0077},
            "force": {"weight": 0.61, "terminal": 3.1},
            "force_rate": {"weight": 2.6e-07},
        },
        "phases": {"circle": {"translation": {"weight": 360.0}}},
    },
}
"""rounded from `pliant study polishing --tune CONTROLLER --trials 16`, the same search for each"""

_NAIVE = {key: value for key, value in _TUNED["force-feedback-mpc"].items() if key != "contact"}
"""force feedback's weights, with the table's own stiffness"""

PRESETS: Mapping[str, Mapping[str, Mapping[str, Any]]] = {
    "tuned": {**_TUNED, "visco-elastic-mpc": _NAIVE},
    "perfect": _PERFECT,
    "paper": {},
}
"""preset → controller → changes to its defaults"""
