"""Cases of the study from the task files of the catalogue, where their numbers stand."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pliant.configuration import validated
from pliant.errors import ConfigError
from pliant.experiments.case import Row
from pliant.studies.stack.config import PRESETS, PathKind, StackCaseConfig
from pliant.studies.stack.paper_task import pushes_of_task, retuning_of, track_of, wall_of
from pliant.tasks import Task, load_task
from pliant.tasks.phase import Track

FAMILY = "stack"
_KINDS: Mapping[str, PathKind] = {"lemniscate": "figure8", "line": "line", "hold": "hold"}
_RULED = {"rmse_x": "RMSE x", "rmse_y": "RMSE y", "rmse_z": "RMSE z", "torque_step": "torque step"}
"""a task's metric → the study's"""


def from_task(file: str, case: str = "") -> StackCaseConfig:
    """The case that a task of the catalogue is.

    Args:
        file: name of the task.
        case: its variant of the same name; empty: the task itself.

    Raises:
        ConfigError: the task is no case of this study.
    """
    task = load_task(file, case or None)
    truth = task.truth
    _, track = track_of(task)
    values = {
        "case": case or file,
        "robot": task.robot,
        "duration": task.phase[0].longest,
        "period": task.simulation.period,
        "physics_step": task.simulation.physics_step,
        "path": _path(track),
        "joints": {
            "friction": truth.joint_friction,
            "damping": truth.joint_damping,
            "compensation": task.compensates,
            "velocity_filter": task.velocity_share,
        },
        "preset": _preset(file, task),
        "wall": wall_of(task) if "wall" in task.scene else None,
        "pushes": pushes_of_task(task) if task.disturbance else None,
        "retuning": retuning_of(task) if task.event else None,
    }
    return validated(StackCaseConfig, values)


def targets_of(file: str, case: str = "") -> dict[str, float]:
    """Metric of the study → its bound in the task's `accept`. Args: as of `from_task`."""
    return {_RULED[name]: bound for name, bound in load_task(file, case or None).accept.items()}


def elbow_rows() -> list[Row]:
    """Other strengths of the elbow's task, from the sweep of the task `balance`."""
    task = load_task("figure8-plain", "balance")
    changes = [entry["control"][FAMILY] for entry in task.sweep["elbow"]]
    forces = [change["tasks"]["elbow"]["translation"]["force_max"] for change in changes]
    return [
        Row(f"elbow-{force:g}N", changes={"control": change}, value=force)
        for force, change in zip(forces, changes, strict=True)
    ]


def _path(track: Track) -> dict[str, Any]:
    """Of a motion its kind and what of it the study can change; places and sizes stay those of the file."""
    if track.beyond_reach:
        return {"kind": "stretch", "ramp": track.ramp}
    own: dict[str, Any] = {"kind": _KINDS[track.shape], "ramp": track.ramp}
    if track.shape == "line":
        own |= {"amplitude": track.size[0], "peak_speed": track.peak_speed}
    elif track.shape == "lemniscate":
        own["period"] = track.period
    return own


def _preset(file: str, task: Task) -> str:
    """The name of the task's parameters. Raises ConfigError where there is none."""
    tasks = task.control[FAMILY]["tasks"]
    for name, preset in PRESETS[FAMILY].items():
        values = preset.model_dump()["tasks"]
        if all(
            values[which][part][key] == value
            for which, parts in tasks.items()
            for part, own in parts.items()
            for key, value in own.items()
        ):
            return name
    raise ConfigError(f"{file}: control.{FAMILY}.tasks are those of no preset: {', '.join(PRESETS[FAMILY])}")
