"""Metrics of a stack run."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from pliant.robot import Robot
from pliant.spatial import Array
from pliant.studies.stack.build import place_of
from pliant.studies.stack.config import StackCaseConfig
from pliant.telemetry import in_parts, metrics
from pliant.telemetry.log import Log
from pliant.telemetry.summary import Metric


def measure(config: StackCaseConfig, robot: Robot, log: Log) -> tuple[Metric, ...]:
    """Metrics from one second after the ramp to the end, on true signals."""
    errors = zip("xyz", tracking_rmse(config, log), strict=True)
    found = [Metric(f"RMSE {axis}", float(error), "mm") for axis, error in errors]
    found += _torques(config, robot, log)
    if config.path.kind == "hold":
        found.append(Metric("joint speed at the end", _rest_speed(log), "rad/s"))
    return (*found, *_attractor(config, log))


def window(config: StackCaseConfig, log: Log) -> npt.NDArray[np.bool_]:
    """Mask of the samples that count."""
    return metrics.between(log.time("measurement/q"), config.settled)


def tracking_rmse(config: StackCaseConfig, log: Log) -> Array:
    """(3,) mm, true tool position against its reference, in the axes of the path: the paper's x, y, z."""
    tool, counts, axes = config.frames()[0], window(config, log), place_of(config).axes
    both = log.parts(f"truth/{tool}/position", f"reference/{tool}/position", where=counts)
    return 1e3 * np.sqrt(in_parts.mean(metrics.error_of(actual @ axes, wanted @ axes) ** 2 for actual, wanted in both))


def _torques(config: StackCaseConfig, robot: Robot, log: Log) -> list[Metric]:
    sent, limits, counts = "command/torque", robot.torque_limit, window(config, log)
    both = ([metrics.peak(part), metrics.torque_step_fraction(part, limits)] for (part,) in log.parts(sent, before=1))
    peak, step = in_parts.largest(map(np.array, both))
    variation = in_parts.of_steps(metrics.torque_variation, log.parts(sent, where=counts, before=1), config.period)
    return [
        Metric("torque variation", variation, "N·m/s"),
        Metric("peak torque", float(peak), "N·m"),
        Metric("torque step", 100.0 * float(step), "% of limit"),
    ]


def _rest_speed(log: Log) -> float:
    last_second = metrics.between(log.time("measurement/q"), log.duration - 1.0)
    return float(in_parts.largest(metrics.peak(part) for (part,) in log.parts("truth/v", where=last_second)))


def _attractor(config: StackCaseConfig, log: Log) -> list[Metric]:
    if "ee/storage_margin" not in log:
        return []
    counts = window(config, log)
    margin = -float(in_parts.largest(-np.min(part[:, :3]) for (part,) in log.parts("ee/storage_margin")))
    switches = in_parts.of_steps(metrics.switch_rate, log.parts("ee/phase", where=counts, before=1), config.period)
    found = [
        Metric("phase switches", switches, "1/s per axis"),
        Metric("storage margin of translation", margin, "J", at_least=True),
    ]
    if config.retuning is not None:
        found.append(Metric("|h| over F_max", largest_share(config, log), "1"))
    return found


def largest_share(config: StackCaseConfig, log: Log) -> float:
    """Largest |h|/F_max over both tasks and all ticks, with the bound in force at each tick."""
    worst = 0.0
    for label, frame in zip(("ee", "elbow"), config.frames(), strict=True):
        force, bound = f"{label}/force", f"reference/{frame}/force_max"
        both = log.parts(force, bound)  # the first change comes after the ramp
        worst = max(worst, float(in_parts.largest(np.max(np.abs(part) / most) for part, most in both)))
    return worst
