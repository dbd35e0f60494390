"""Metrics of a list of phases, on the true signals."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from pliant.errors import ConfigError, options
from pliant.signals import TaskReference
from pliant.spatial import Array
from pliant.studies.task.config import TaskCase
from pliant.studies.task.list_motion import Listed
from pliant.studies.task.listed import frame_of, placed_phases_of, tracks_of
from pliant.tasks.phase import Track
from pliant.telemetry import metrics as of
from pliant.telemetry.contact_metrics import contact_breaks
from pliant.telemetry.log import Log
from pliant.telemetry.summary import Metric

_AFTER_THE_RAMP = 1.0  # s
_TRACKING = ("rmse_x", "rmse_y", "rmse_z", "torque_variation", "torque_step", "torque_share")
_OF_A_PHASE = {"force_rms": "N", "force_max": "N", "contact_breaks": "", "position_max": "mm"}
_ON_SILENT_AXES = ("side_force_max", "side_moment_max")


def names_of(case: TaskCase) -> tuple[str, ...]:
    """Of all metrics, as `accept` can bound them."""
    if tracks_of(case):
        return _TRACKING
    return (
        *(f"{phase}/{name}" for phase in case.phase_names() for name in (*_OF_A_PHASE, *_ON_SILENT_AXES)),
        "force_peak",
        "torque_share",
    )


def check_accept_of_list(case: TaskCase) -> None:
    """Raises ConfigError for a metric that there is not."""
    names = names_of(case)
    for name in case.accept:
        if name not in names:
            raise ConfigError(f"accept: there is no metric {name!r}; {options(names, name)}")


def measured_list(case: TaskCase, made: Listed, log: Log) -> tuple[Metric, ...]:
    """All metrics that the log has, with the bound that the task puts on them."""
    limits = made.robot.torque_limit
    share = 100.0 * of.peak(np.abs(log["command/torque"]) / limits)
    found = _tracking(case, made, log) if made.tracked is not None else _pressing(case, made, log)
    found["torque_share"] = (share, "%")
    return tuple(Metric(name, value, unit, target=case.accept.get(name)) for name, (value, unit) in found.items())


def _tracking(case: TaskCase, made: Listed, log: Log) -> dict[str, tuple[float, str]]:
    """Of the first frame from one second after the ramp; of a shorter run, of all of it."""
    frame = made.believed.frames[0]
    time = log.time("measurement/q")
    track = case.phase[0].tracks[frame]
    begin = track.ramp + _AFTER_THE_RAMP if isinstance(track, Track) else 0.0
    counts = of.between(time, begin if time[-1] > begin else 0.0)
    rmse = 1e3 * of.rmse(log[f"truth/{frame}/position"][counts], log[f"reference/{frame}/position"][counts])
    found = {f"rmse_{axis}": (float(error), "mm") for axis, error in zip("xyz", rmse, strict=True)}
    torque = log["command/torque"]
    found["torque_variation"] = (of.torque_variation(torque[counts], case.simulation.period), "N·m/s")
    found["torque_step"] = (100.0 * of.torque_step_fraction(torque, made.robot.torque_limit), "%")
    return found


def _pressing(case: TaskCase, made: Listed, log: Log) -> dict[str, tuple[float, str]]:
    """Along each phase's wrench as the reference has it, events included; from `settle` after its beginning."""
    frame = frame_of(case)
    time, whole = log.time("measurement/q"), log[f"truth/{frame}/wrench"]
    force = whole[:, :3]
    wanted, beside = log[f"reference/{frame}/wrench"][:, :3], log[f"truth/{frame}/position"]
    off = np.linalg.norm(beside - log[f"reference/{frame}/position"], axis=1)
    all_placed = placed_phases_of(case, made.robot, np.eye(3))
    found: dict[str, tuple[float, str]] = {}
    for placed, phase in zip(all_placed, case.phase, strict=True):
        inside = within(log, time, placed.name, phase.settle)
        if not inside.any():
            continue
        size = float(np.linalg.norm(placed.task.wrench[:3]))
        if size > 0.0:
            along = placed.task.wrench[:3] / size
            felt, asked = force[inside] @ along, wanted[inside] @ along
            found[f"{placed.name}/force_rms"] = (of.rms_error(felt, asked), "N")
            found[f"{placed.name}/force_max"] = (of.max_error(felt, asked), "N")
            found[f"{placed.name}/contact_breaks"] = (float(contact_breaks(felt)), "")
        found |= {f"{placed.name}/{name}": value for name, value in on_silent_axes(placed.task, whole[inside]).items()}
        found[f"{placed.name}/position_max"] = (1e3 * float(off[inside].max()), "mm")
    found["force_peak"] = (of.peak(np.linalg.norm(force, axis=1)), "N")
    return found


def on_silent_axes(task: TaskReference, wrench: Array) -> dict[str, tuple[float, str]]:
    """Largest force and moment along the axes on which a task asks for 0 N or 0 N·m; empty without one.

    Args:
        task: with its modes.
        wrench: (k, 6) N and N·m, world axes.
    """
    if task.modes is None:
        return {}
    asked, found = task.modes.into(task.wrench), dict[str, tuple[float, str]]()
    silent = np.array(task.modes.having("force")) & (np.abs(asked) < 1e-9)
    for begin, name, unit in ((0, _ON_SILENT_AXES[0], "N"), (3, _ON_SILENT_AXES[1], "N·m")):
        axes = task.modes.rotation[:, silent[begin : begin + 3]]
        if axes.size:
            found[name] = (of.peak(np.linalg.norm(wrench[:, begin : begin + 3] @ axes, axis=1)), unit)
    return found


def within(log: Log, time: Array, name: str, settle: float) -> npt.NDArray[np.bool_]:
    """(k,): the reference is in a phase, and has been for `settle` s."""
    found = np.zeros(len(time), dtype=np.bool_)
    phases = log.phases()
    ends = [begin for begin, _ in phases[1:]] + [np.inf]
    for (begin, phase), end in zip(phases, ends, strict=True):
        if phase == name:
            found |= of.between(time, begin + settle, end)
    return found
