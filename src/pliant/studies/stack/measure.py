"""What a stack run is judged by."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache

import numpy as np
import numpy.typing as npt

from pliant import loop
from pliant.robot import Robot
from pliant.spatial import Array
from pliant.studies.stack.build import build, place_of
from pliant.studies.stack.config import StackConfig
from pliant.telemetry import metrics
from pliant.telemetry.log import Log
from pliant.telemetry.recorder import Recorder
from pliant.telemetry.summary import Metric

JUDGED = "stack"
"""the controller that the targets are for"""

PAPER_RMSE: Mapping[str, tuple[float, float, float]] = {
    "figure8-plain": (5.6, 4.6, 6.1),
    "figure8-gazebo": (5.6, 4.6, 6.1),
    "figure8-wall": (13.2, 4.2, 5.5),
    "figure8-hardware": (7.6, 1.5, 8.6),
    "figure8-pushed": (20.3, 7.9, 9.1),
    "line-hardware": (6.1, 4.6, 6.7),
    "line-pushed": (9.6, 7.7, 7.3),
}
"""mm, x y z; [Stack] sec. IV. The last four were measured on hardware"""
TARGET_RMSE: Mapping[str, tuple[float, float, float]] = {
    "figure8-plain": (1.0, 1.2, 3.5),
    "figure8-gazebo": (4.0, 2.5, 3.5),
    "figure8-hardware": (3.5, 2.5, 2.5),
    "figure8-pushed": (5.0, 6.0, 5.5),
    "line-hardware": (6.0, 3.0, 4.0),
    "line-pushed": (8.0, 7.5, 5.5),
}
"""mm, x y z"""
TORQUE_STEP_TARGET = {"figure8-wall": 15.0, "singular": 15.0}
"""case → largest change of a torque per tick, % of the joint's limit"""


def measure(config: StackConfig, robot: Robot, log: Log) -> tuple[Metric, ...]:
    """Metrics from one second after the ramp to the end, on true signals."""
    case, pliant = config.case, config.controller == JUDGED
    paper = PAPER_RMSE.get(case, (None,) * 3)
    target = TARGET_RMSE.get(case, (None,) * 3) if pliant else (None,) * 3
    found = [
        Metric(f"RMSE {axis}", float(error), "mm", paper[i], target[i])
        for i, (axis, error) in enumerate(zip("xyz", tracking_rmse(config, log), strict=True))
    ]
    if config.wall is not None:
        found += _against_no_wall(config, log)
    found += _torques(config, robot, log, pliant)
    if config.path.kind == "hold":
        found.append(Metric("joint speed at the end", _rest_speed(log), "rad/s", target=0.01 if pliant else None))
    return (*found, *_attractor(config, log, pliant))


def window(config: StackConfig, log: Log) -> npt.NDArray[np.bool_]:
    """Mask of the samples that count."""
    return metrics.between(log.time("measurement/q"), config.settled)


def tracking_rmse(config: StackConfig, log: Log) -> Array:
    """(3,) mm, true tool position against its reference, in the axes of the path: the paper's x, y, z."""
    tool, counts, axes = config.frames()[0], window(config, log), place_of(config).axes
    actual, wanted = (log[f"{kind}/{tool}/position"][counts] @ axes for kind in ("truth", "reference"))
    return 1e3 * metrics.rmse(actual, wanted)


def _against_no_wall(config: StackConfig, log: Log) -> list[Metric]:
    """How much the wall, which stops x, disturbs the axes that stay free: the same run without it beside."""
    free = _rmse_without_wall(config.model_copy(update={"wall": None}).model_dump_json())
    here = tracking_rmse(config, log)
    bound = 0.5 if config.controller == JUDGED else None
    return [
        Metric(f"RMSE {'xyz'[axis]}: change by the wall", float(abs(here[axis] - free[axis])), "mm", target=bound)
        for axis in (1, 2)
    ]


@cache
def _rmse_without_wall(config_json: str) -> tuple[float, float, float]:
    config = StackConfig.model_validate_json(config_json)
    wired = build(config)
    recorder = Recorder(None)
    loop.run(
        wired.plant,
        wired.estimator,
        wired.source,
        wired.controller,
        range(round(config.duration / config.period)),
        [recorder],
    )
    x, y, z = tracking_rmse(config, recorder.log())
    return float(x), float(y), float(z)


def _torques(config: StackConfig, robot: Robot, log: Log, pliant: bool) -> list[Metric]:
    counts, torque = window(config, log), log["command/torque"]
    step = 100.0 * metrics.torque_step_fraction(torque, robot.torque_limit)
    variation = metrics.torque_variation(torque[counts], config.period)
    smooth = 100.0 if config.case == "figure8-plain" and pliant else None
    return [
        Metric("torque variation", variation, "N·m/s", target=smooth),
        Metric("peak torque", metrics.peak(torque), "N·m"),
        Metric("torque step", step, "% of limit", target=TORQUE_STEP_TARGET.get(config.case) if pliant else None),
    ]


def _rest_speed(log: Log) -> float:
    last_second = metrics.between(log.time("measurement/q"), log.duration - 1.0)
    return metrics.peak(log["truth/v"][last_second])


def _attractor(config: StackConfig, log: Log, pliant: bool) -> list[Metric]:
    if "ee/storage_margin" not in log:
        return []
    counts = window(config, log)
    margin = float(np.min(log["ee/storage_margin"][:, :3]))
    found = [
        Metric("phase switches", metrics.switch_rate(log["ee/phase"][counts], config.period), "1/s per axis"),
        Metric("storage margin of translation", margin, "J", target=-0.05 if pliant else None, at_least=True),
    ]
    if config.retuning is not None:
        found.append(Metric("|h| over F_max", largest_share(config, log), "1", target=1.0 if pliant else None))
    return found


def largest_share(config: StackConfig, log: Log) -> float:
    """Largest |h|/F_max over both tasks and all ticks, with the bound in force at each tick."""
    worst = 0.0
    for label, frame in zip(("ee", "elbow"), config.frames(), strict=True):
        force = np.abs(log[f"{label}/force"])
        bound = log[f"reference/{frame}/force_max"]
        worst = max(worst, float(np.max(force[-len(bound) :] / bound)))  # the first change comes after the ramp
    return worst
