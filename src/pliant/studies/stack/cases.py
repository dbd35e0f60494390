"""The cases of the stack study, each with its rows, the paper's numbers and the targets."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from pliant.experiments.case import Case, Pair, Row, once, seeded
from pliant.studies.stack.balance import balance_figure
from pliant.studies.stack.config import StackCaseConfig
from pliant.studies.stack.from_task import elbow_rows, from_task, targets_of

JUDGED = "stack"
"""the controller that the targets are for"""
_ARMS = ("stack-paper", "spring", "operational-space")
_PUSHED = seeded(10)
_PASSIVE = {"storage margin of translation": -0.05}  # J
_TABLE_1 = {"stiff": "table-1-simulation", "soft": "table-1-robot"}
"""a case's preset → that of the paper's Table I"""


def _rows(config: StackCaseConfig) -> list[Row]:
    """The stack, it with Table I's parameters, and the baselines, all on the first seed but the stack itself."""
    printed = {"preset": _TABLE_1[config.preset]}
    return [
        Row(draws=once if config.pushes is None else _PUSHED),
        Row("table-1", changes=printed),
        *(Row(controller=arm, shown=False) for arm in _ARMS),
        Row("table-1", "stack-paper", printed),
    ]


def _xyz(x: float, y: float, z: float) -> dict[str, float]:
    """mm, of the tool, in the axes of the path."""
    return {"RMSE x": x, "RMSE y": y, "RMSE z": z}


def _case(
    file: str, case: str = "", *more: Row, rows: Sequence[Row] | None = None, **other: Any
) -> Case[StackCaseConfig]:
    """A case of a task file with the usual rows and some more, or other rows. Its targets are over the file's."""
    config = from_task(file, case)
    targets = _PASSIVE | targets_of(file, case) | other.pop("targets", {})
    chosen = [*_rows(config), *more] if rows is None else rows
    return Case(config, chosen, judged=JUDGED, targets=targets, **other)


def _no_wall(controller: str | None) -> Row:
    """The same run without what stands in the way of x: its partner shows how much the free axes feel of the wall."""
    return Row("no wall", controller, {"wall": None})


def _wall_moves(axis: str) -> Pair:
    """By how much the wall changes a free axis."""
    name = f"RMSE {axis}"
    return Pair(f"{name}: change by the wall", name, "", "no wall", absolute=True, targets={JUDGED: 0.5})


_WRONG_MASSES = Row("masses ± 20 %", "operational-space", {"model_mass_error": 0.2}, draws=seeded(10), shown=False)
"""the baseline that knows the masses with each of them off by up to 20 %"""
_AS_PRINTED = Row(
    "profile as printed",
    changes={"control": {"tasks": {task: {"profile": "exponential-printed"} for task in ("ee", "elbow")}}},
    shown=False,
)
"""[Stack] eq. 3 without the factor ΔF, under pliant's law"""

# The paper's numbers: [Stack] sec. IV, mm; those of hardware, pushed and line were measured on its robot.
_ALL = (
    _case(
        "figure8-plain",
        "figure8-wall",
        *(_no_wall(controller) for controller in (None, *_ARMS)),
        paper=_xyz(13.2, 4.2, 5.5),
        targets={"torque step": 15.0},
        pairs=[_wall_moves(axis) for axis in "yz"],
    ),
    _case("figure8-plain", "", _AS_PRINTED, paper=_xyz(5.6, 4.6, 6.1), targets={"torque variation": 100.0}),
    _case("figure8-plain", "figure8-gazebo", _WRONG_MASSES, _AS_PRINTED, paper=_xyz(5.6, 4.6, 6.1)),
    _case("figure8-hardware", "", _WRONG_MASSES, paper=_xyz(7.6, 1.5, 8.6)),
    _case("figure8-hardware", "figure8-pushed", paper=_xyz(20.3, 7.9, 9.1)),
    _case("line-hardware", paper=_xyz(6.1, 4.6, 6.7)),
    _case("line-hardware", "line-pushed", paper=_xyz(9.6, 7.7, 7.3)),
    _case("line-hardware", "line-slow"),
    _case("rest-plain", targets={"joint speed at the end": 0.01}),
    _case("singular"),
    _case(
        "figure8-plain",
        "calibration",
        targets={"|h| over F_max": 1.0},
        rows=[
            Row(draws=_PUSHED),
            Row("x_0 and x_b too", changes={"retuning": {"ranges": True}}, draws=_PUSHED),
        ],
    ),
    _case("figure8-plain", "balance", rows=elbow_rows(), figures=[balance_figure]),
)
CASES: Mapping[str, Case[StackCaseConfig]] = {case.config.case: case for case in _ALL}
"""by name; the first is what `pliant run` does"""
