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

PRESETS: Mapping[str, Mapping[str, Mapping[str, Any]]] = {"tuned": _PERFECT, "perfect": _PERFECT, "paper": {}}
"""preset → controller → changes to its defaults"""
