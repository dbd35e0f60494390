"""How the compared controllers of the study are tuned: the same plant, runs, objective and count of trials for each."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from pliant.configuration import merged
from pliant.dotted import nested
from pliant.errors import ConfigError, options
from pliant.experiments.base import Result
from pliant.experiments.parameter_search import ParameterSearch, Range
from pliant.studies.stack.config import PRESETS, StackCaseConfig

_DURATION = 7.0  # s: one round of the figure-8 after the ramp
_RMSE = ("RMSE x", "RMSE y", "RMSE z")
_FORCES: Mapping[str, Range] = {
    "ee stiffness": Range(1e3, 4e4, log=True),
    "ee linear range": Range(2e-3, 5e-2, log=True),
    "elbow stiffness": Range(2e2, 1e4, log=True),
}
_DAMPER = {"control.joint_damping": Range(0.05, 20.0, log=True)}
_INVERSE = {
    "control.stiffness": Range(1e2, 2e4, log=True),
    "control.damping_ratio": Range(0.3, 2.0),
    "control.posture_stiffness": Range(5.0, 400.0, log=True),
    "control.singularity_damping": Range(1e-3, 0.1, log=True),
}


@dataclass(frozen=True)
class _Search:
    parameters: Mapping[str, Range]
    first: Mapping[str, float]
    """values that have no default to start from"""


_SEARCHES: Mapping[str, _Search] = {
    "stack": _Search(_FORCES, {}),
    "spring": _Search({**_FORCES, **_DAMPER}, {"control.joint_damping": 1.0}),
    "operational-space": _Search(
        _INVERSE,
        {
            "control.stiffness": 400.0,
            "control.damping_ratio": 1.0,
            "control.posture_stiffness": 50.0,
            "control.singularity_damping": 0.02,
        },
    ),
}


def search_of(case: StackCaseConfig, controller: str) -> ParameterSearch:
    """The search over a controller's parameters on the plant of a case.

    Raises:
        ConfigError: a controller that is not searched.
    """
    if controller not in _SEARCHES:
        raise ConfigError(f"controller {controller!r} of study 'stack' has no search; {options(_SEARCHES, controller)}")
    search = _SEARCHES[controller]
    config = merged(case, {"controller": controller, "control": {}, "duration": _DURATION})
    preset = PRESETS["stack"][config.preset].model_dump()["tasks"]
    ee = preset["ee"]["translation"]
    begin = {
        "ee stiffness": ee["stiffness"],
        "ee linear range": ee["linear_range"],
        "elbow stiffness": preset["elbow"]["translation"]["stiffness"],
        **search.first,
    }
    start = {name: float(begin[name]) for name in search.parameters}
    return ParameterSearch(search.parameters, [config], _objective, start, _changes)


def _objective(results: Sequence[Result]) -> float:
    """Length of the tool's RMSE over the three axes, mm, mean over the runs."""
    values = [{metric.name: metric.value for metric in result.metrics} for result in results]
    return float(np.mean([np.linalg.norm([found[name] for name in _RMSE]) for found in values]))


def _changes(values: Mapping[str, float]) -> Mapping[str, Any]:
    """Stiffness and linear range of an impedance decide its F_max = 1.25 K_0 x_0 and x_b = 3 x_0."""
    changes = nested({name: value for name, value in values.items() if name.startswith("control.")})
    if "ee stiffness" in values:
        ee = _impedance(values["ee stiffness"], values["ee linear range"])
        elbow = _impedance(values["elbow stiffness"], 0.01)
        changes.setdefault("control", {})["tasks"] = {"ee": {"translation": ee}, "elbow": {"translation": elbow}}
    return changes


def _impedance(stiffness: float, bend: float) -> Mapping[str, float]:
    return {"stiffness": stiffness, "linear_range": bend, "range": 3.0 * bend, "force_max": 1.25 * stiffness * bend}
