"""What [FFMPC] prints as tables: its simulation (II to IV) and its robot (V to VII, Fig. 4), with its numbers."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from pliant.experiments.case import Case, Pair, PaperTable, Row, once, seeded
from pliant.studies.polishing.compared import compared
from pliant.studies.polishing.config import PolishingConfig
from pliant.studies.polishing.rows import (
    ALL,
    BEST,
    DELAY,
    ROWS,
    STOCK,
    TILTS,
    WITHOUT_LOOP,
    case_config,
    delayed,
    imperfect,
    tilted,
)
from pliant.studies.polishing.work_config import RepeatedPushes

_HEADINGS = {
    "E_P": "E_P, mm",
    "E_λ": "E_λ, N",
    "λ_max": "λ_max, N",
    "λ_dev": "max \\|f − f̄\\|, N",
    "t_break": "t_break, %",
}
_FORCE = "force-feedback-mpc"
_WITH, _WITHOUT = "PID", "no PID"
_PAPER: Mapping[str, Mapping[str, tuple[float, float, float]]] = {
    _WITHOUT: {
        "E_P": (5.75, 2.44, 4.59),
        "E_λ": (25.52, 33.98, 10.55),
        "λ_max": (59.36, 105.57, 110.95),
        "t_break": (0.51, 32.75, 0.00),
    },
    _WITH: {
        "E_P": (7.94, 3.87, 3.07),
        "E_λ": (15.21, 12.44, 2.04),
        "λ_max": (185.75, 211.00, 111.97),
        "t_break": (0.00, 0.00, 0.00),
    },
}
"""Tables II and III: drives without and with the torque loop → metric → number per controller; mm, N, N, %"""
_PAIRS = [
    Pair("ΔE_λ", "E_λ", _WITHOUT, _WITH, paper=dict(zip(STOCK, (10.31, 21.55, 8.51), strict=True))),
    Pair("ΔE_τ", "E_τ", _WITHOUT, _WITH, paper=dict(zip(STOCK, (2.24, 2.20, 1.95), strict=True))),
]
"""Table IV: without minus with the torque loop"""


def _numbers(table: Mapping[str, tuple[float, float, float]], controller: str) -> dict[str, float]:
    if controller not in STOCK:
        return {}
    return {metric: numbers[STOCK.index(controller)] for metric, numbers in table.items()}


def _simulated(
    name: str, controller: str | None, delay: float, targets: Mapping[tuple[str, str], Mapping[str, float]]
) -> Case[PolishingConfig]:
    """Tables II to IV: tilts × seeds, with and without the torque loop. Args: targets: (label, controller) → bounds."""
    loops: dict[str, Mapping[str, Any]] = {_WITH: {}, _WITHOUT: WITHOUT_LOOP}
    rows = [
        Row(
            label,
            own,
            changes,
            paper=_numbers(_PAPER[label], own),
            targets=targets.get((label, own), {}),
            shown=True,
        )
        for label, changes in loops.items()
        for own in (ALL if delay else STOCK)
    ]
    late = "δ_o = 5 ms" if delay else "δ_o = 0"
    return Case(
        case_config(name, **imperfect(delay=delay), **({} if controller is None else {"controller": controller})),
        rows,
        tilted(TILTS, 10),
        alone=_WITH,
        pairs=_PAIRS,
        tables=[
            PaperTable(f"Table II, without the drives' torque loop, {late}", _HEADINGS, _WITHOUT),
            PaperTable(f"Table III, with the drives' torque loop, {late}", _HEADINGS, _WITH),
            PaperTable(
                f"Table IV, without minus with the torque loop, {late}",
                {"ΔE_λ": "ΔE_λ, N", "ΔE_τ": "ΔE_τ, N·m"},
                _WITHOUT,
            ),
        ],
        figures=[ROWS],
    )


def _robot_like(
    name: str, title: str, paper: Mapping[str, tuple[float, float, float]], figure: int, **changes: Any
) -> Case[PolishingConfig]:
    """The paper's experiments on its robot: its three controllers without δ_o, pliant's own with it."""
    return Case(
        case_config(name, **changes, **imperfect()),
        [Row("", own, delayed(own), paper=_numbers(paper, own)) for own in ALL],
        seeded(5),
        tables=[PaperTable(title, _HEADINGS)],
        figures=[compared(figure)],
    )


_BEST = {"λ_max": 58.0, "t_break": 0.0, "first contact peak": 30.0}
_TILTED = {"tilt": math.radians(6.0)}
_FAST = {"speed": 6.0}
_ROBOT = "(the paper's numbers: on its robot)"
_IDEAL = {"E_λ": 0.5, "E_P": 1.0, "t_break": 0.0}

TABLE_CASES: tuple[Case[PolishingConfig], ...] = (
    Case(
        case_config("ideal", preset="perfect"),
        [
            *(Row("", own, targets=_IDEAL if own == _FORCE else {}) for own in STOCK),
            *(Row("paper-weights", own, {"preset": "paper"}) for own in STOCK),
        ],
        once,
    ),
    _simulated("tables-2-3-4", None, 0.0, {(_WITH, _FORCE): {"E_λ": 4.0}}),
    _simulated(
        "tables-2-3-4-delayed",
        BEST,
        DELAY,
        {(_WITH, BEST): {"E_λ": 0.5, "E_P": 0.5, **_BEST}, (_WITHOUT, BEST): {"E_λ": 0.6, "E_P": 0.6, **_BEST}},
    ),
    _robot_like(
        "square", f"Force steps on one spot {_ROBOT}", {"E_λ": (2.76, 2.70, 2.16)}, 4, task={"pattern": "square"}
    ),
    _robot_like(
        "slow",
        f"Table V, slow circle, horizontal table {_ROBOT}",
        {"E_λ": (9.31, 4.28, 1.70), "E_P": (6.48, 3.23, 3.10)},
        6,
    ),
    _robot_like(
        "slow-tilted",
        f"Table VI, slow circle, tilted table {_ROBOT}",
        {"E_λ": (9.49, 9.67, 2.12), "E_P": (7.04, 3.37, 3.34)},
        7,
        table=_TILTED,
    ),
    _robot_like(
        "fast-tilted",
        f"Table VII, fast circle, tilted table {_ROBOT}",
        {"E_λ": (9.00, 11.40, 1.84), "E_P": (10.85, 5.41, 5.29)},
        8,
        table=_TILTED,
        task=_FAST,
    ),
    _robot_like("fast-pushed", "Fast circle under pushes", {}, 9, task=_FAST, pushes=RepeatedPushes().model_dump()),
)
