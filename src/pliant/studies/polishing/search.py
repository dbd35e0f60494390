"""How each controller of the study is tuned: the same weights, runs and objective for all of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from pliant.configuration import merged
from pliant.errors import ConfigError
from pliant.experiments.base import Result
from pliant.experiments.parameter_search import ParameterSearch, Range
from pliant.simulation import Imperfections
from pliant.studies.polishing.config import PolishingConfig
from pliant.studies.polishing.rows import BEST

_FIRST_SEED = 1000  # far from those of the tables
_DURATION = 5.0  # s, of which 2 s on the circle

_COMMON = {
    "posture": Range(2e-4, 0.2, log=True),
    "torque": Range(1e-6, 1e-3, log=True),
    "rotation": Range(2.0, 200.0, log=True),
    "velocity": Range(0.005, 0.5, log=True),
    "circle": Range(10.0, 5000.0, log=True),
}
_FORCE = {"force": Range(1e-3, 1.0, log=True), "force_rate": Range(6e-8, 6e-6, log=True)}
_TERMINAL = 5.0
"""weight of the force at the last node over that of the others, as in the paper"""


def search_of(case: PolishingConfig, controller: str) -> ParameterSearch:
    """The search over a controller's weights; force weights only where they change anything (force feedback)."""
    config = merged(case, {"controller": controller})
    now = config.parameters().model_dump()
    if "costs" not in now:
        raise ConfigError(f"controller {controller!r} has no weights that this study knows how to search")
    parameters = {**_COMMON, **(_FORCE if now["kind"] == "force_feedback" else {})}
    return ParameterSearch(parameters, _runs(config), _objective, _start(config, parameters), _changes)


def _runs(config: PolishingConfig) -> Sequence[PolishingConfig]:
    """Both tilts, with and without the drives' torque loop; δ_o of the case, 5 ms for the best."""
    delay = 5e-3 if config.controller == BEST else config.imperfections.computation_delay
    return [
        merged(
            config,
            {
                "duration": _DURATION,
                "seed": _FIRST_SEED + place,
                "table": {"tilt": tilt},
                "imperfections": Imperfections.p3(pid=pid, computation_delay=delay).model_dump(),
            },
        )
        for place, (tilt, pid) in enumerate([(0.1, True), (-0.1, True), (0.06, False), (-0.06, False)])
    ]


def _objective(results: Sequence[Result]) -> float:
    """E_λ in N plus E_P in mm plus a twentieth of the largest force error in N, mean over the runs."""
    values = [{metric.name: metric.value for metric in result.metrics} for result in results]
    return float(np.mean([found["E_λ"] + found["E_P"] + 0.05 * found["λ_dev"] for found in values]))


def _start(config: PolishingConfig, parameters: Mapping[str, Range]) -> Mapping[str, float]:
    """Today's values, moved into the ranges where they lie outside."""
    now = config.parameters().model_dump()
    circle = now["phases"]["circle"]["translation"] or {"weight": 0.0}
    values = {name: float(now["costs"][name]["weight"]) for name in parameters if name != "circle"}
    values["circle"] = float(circle["weight"])
    return {name: min(max(values[name], about.low), about.high) for name, about in parameters.items()}


def _changes(values: Mapping[str, float]) -> Mapping[str, Any]:
    costs: dict[str, Any] = {name: {"weight": value} for name, value in values.items() if name != "circle"}
    if "force" in costs:
        costs["force"]["terminal"] = _TERMINAL * values["force"]
    return {"control": {"costs": costs, "phases": {"circle": {"translation": {"weight": values["circle"]}}}}}
