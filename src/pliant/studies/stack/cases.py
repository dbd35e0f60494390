"""The cases of the stack study, each with its rows, the paper's numbers and the targets."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from pliant.experiments.case import Case, Pair, Row, once, seeded
from pliant.studies.stack.balance import balance_figure
from pliant.studies.stack.config import GainChanges, Joints, RandomPushes, StackCaseConfig, StackPath, Wall

JUDGED = "stack"
"""the controller that the targets are for"""
_ARMS = ("stack-paper", "spring", "operational-space")
_PUSHED = seeded(10)
_PASSIVE = {"storage margin of translation": -0.05}  # J
_BALANCE_FORCES = (0.0, 5.0, 10.0, 20.0, 35.0, 50.0, 75.0, 100.0)  # N, of the elbow's task

_GAZEBO = Joints(friction=10.0, damping=1.0, compensation="gravity", velocity_filter=0.2)
_HARDWARE = Joints(friction=0.5, damping=0.5, compensation="gravity+coriolis")
_HARDWARE_LOOP: dict[str, Any] = {"period": 3e-3, "joints": _HARDWARE, "preset": "soft"}
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
    config: StackCaseConfig,
    paper: Mapping[str, float] | None = None,
    targets: Mapping[str, float] | None = None,
    rows: Sequence[Row] | None = None,
    **more: Any,
) -> Case[StackCaseConfig]:
    rows = _rows(config) if rows is None else rows
    return Case(config, rows, judged=JUDGED, paper=paper or {}, targets=_PASSIVE | dict(targets or {}), **more)


def _no_wall(controller: str | None) -> Row:
    """The same run without what stands in the way of x: its partner shows how much the free axes feel of the wall."""
    return Row("no wall", controller, {"wall": None})


def _wrong_masses(config: StackCaseConfig) -> list[Row]:
    """The rows of a case, and the baseline that knows the masses with each of them off by up to 20 %."""
    wrong = Row("masses ± 20 %", "operational-space", {"model_mass_error": 0.2}, draws=seeded(10), shown=False)
    return [*_rows(config), wrong]


def _elbow(force: float) -> Row:
    """Another strength of the elbow's task; 0 N switches it off."""
    own = {"stiffness": 0.0} if force == 0.0 else {"linear_range": min(0.01, 0.5 * force / 5000.0)}
    changes = {"control": {"tasks": {"elbow": {"translation": {"force_max": force, **own}}}}}
    return Row(f"elbow-{force:g}N", changes=changes, value=force)


_WALL = StackCaseConfig(case="figure8-wall", wall=Wall(), joints=_GAZEBO)
_FRICTION = StackCaseConfig(case="figure8-gazebo", joints=_GAZEBO)
_LATE = StackCaseConfig(case="figure8-hardware", **_HARDWARE_LOOP)
_RESTING = RandomPushes(frame="flange", gap=(0.5, 0.6), end=6.0)

# The paper's numbers: [Stack] sec. IV, mm; those of hardware, pushed and line were measured on its robot.
_ALL = (
    _case(
        _WALL,
        _xyz(13.2, 4.2, 5.5),
        {"torque step": 15.0},
        [*_rows(_WALL), *(_no_wall(controller) for controller in (None, *_ARMS))],
        pairs=[
            Pair(
                f"RMSE {axis}: change by the wall", f"RMSE {axis}", "", "no wall", absolute=True, targets={JUDGED: 0.5}
            )
            for axis in "yz"
        ],
    ),
    _case(
        StackCaseConfig(case="figure8-plain"),
        _xyz(5.6, 4.6, 6.1),
        _xyz(1.0, 1.2, 3.5) | {"torque variation": 100.0},
    ),
    _case(_FRICTION, _xyz(5.6, 4.6, 6.1), _xyz(4.0, 2.5, 3.5), _wrong_masses(_FRICTION)),
    _case(_LATE, _xyz(7.6, 1.5, 8.6), _xyz(3.5, 2.5, 2.5), _wrong_masses(_LATE)),
    _case(
        StackCaseConfig(case="figure8-pushed", **_HARDWARE_LOOP, pushes=RandomPushes()),
        _xyz(20.3, 7.9, 9.1),
        _xyz(5.0, 6.0, 5.5),
    ),
    _case(
        StackCaseConfig(case="line-hardware", path=StackPath(kind="line"), **_HARDWARE_LOOP),
        _xyz(6.1, 4.6, 6.7),
        _xyz(6.0, 3.0, 4.0),
    ),
    _case(
        StackCaseConfig(case="line-pushed", path=StackPath(kind="line"), pushes=RandomPushes(), **_HARDWARE_LOOP),
        _xyz(9.6, 7.7, 7.3),
        _xyz(8.0, 7.5, 5.5),
    ),
    _case(StackCaseConfig(case="line-slow", path=StackPath(kind="line", peak_speed=0.4), **_HARDWARE_LOOP)),
    _case(
        StackCaseConfig(case="rest-plain", path=StackPath(kind="hold"), pushes=_RESTING, duration=10.0),
        targets={"joint speed at the end": 0.01},
    ),
    _case(
        StackCaseConfig(case="singular", path=StackPath(kind="stretch"), **_HARDWARE_LOOP),
        targets={"torque step": 15.0},
    ),
    _case(
        StackCaseConfig(case="calibration", retuning=GainChanges(), joints=_GAZEBO),
        targets={"|h| over F_max": 1.0},
        rows=[
            Row(draws=_PUSHED),
            Row("x_0 and x_b too", changes={"retuning": {"ranges": True}}, draws=_PUSHED),
        ],
    ),
    _case(
        StackCaseConfig(case="balance", joints=_GAZEBO),
        rows=[_elbow(force) for force in _BALANCE_FORCES],
        figures=[balance_figure],
    ),
)
CASES: Mapping[str, Case[StackCaseConfig]] = {case.config.case: case for case in _ALL}
"""by name; the first is what `pliant run` does"""
