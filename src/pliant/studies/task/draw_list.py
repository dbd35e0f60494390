"""Figures of a run of a list of phases: signals over time, and the robot among its things."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from pliant.experiments.base import Experiment
from pliant.simulation import ImperfectPlant, MujocoPlant
from pliant.simulation.snapshot import Arrow, Camera, Path3, Snapshot
from pliant.studies.figures import Later, pictures_later, saved_figures
from pliant.studies.task.config import TaskCase
from pliant.studies.task.list_motion import Listed
from pliant.telemetry.log import Log
from pliant.telemetry.plots import Curve, Panel, time_series
from pliant.telemetry.plots.pictures import picture_row

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_METRES_PER_NEWTON = 0.004
_TRACE, _FORCE = (0.95, 0.45, 0.10, 1.0), (0.76, 0.18, 0.18, 1.0)
_POINTS = 300  # of a trace, about
_SHOWN = 0.005  # N; a smaller force has no arrow
_SHARES = (0.02, 0.35, 0.65, 0.98)
"""of the run, at which the robot is drawn"""


def list_figures(case: TaskCase, made: Listed, experiment: Experiment, log: Log, folder: Path) -> list[Path]:
    """Force, place and torque over time; the robot at four moments."""
    figures = {"scene": _moments(case, made, experiment, log), "history": _history(case, made, log)}
    return saved_figures(case, folder, figures)


def _history(case: TaskCase, made: Listed, log: Log) -> Figure:
    frame, time = made.believed.frames[0], log.time("measurement/q")
    place, wanted = log[f"truth/{frame}/position"], log[f"reference/{frame}/position"]
    panels = [Panel(f"off its reference, {axis}, mm", [Curve("", time, 1e3 * (place - wanted)[:, index])])
              for index, axis in enumerate("xyz")]  # fmt: skip
    if made.believed.presses is not None:
        felt, asked = log[f"truth/{frame}/wrench"], log[f"reference/{frame}/wrench"]
        used = [axis for axis in range(3) if np.any(asked[:, axis])]
        panels = [
            Panel(
                f"force along {'xyz'[axis]}, N",
                [Curve("true", time, felt[:, axis]), Curve("asked", time, asked[:, axis], "reference")],
            )
            for axis in used
        ] + panels
    share = 100.0 * (np.abs(log["command/torque"]) / made.robot.torque_limit).max(axis=1)
    panels.append(Panel("largest torque, % of its limit", [Curve("", time, share)]))
    title = " · ".join(part for part in (case.case, case.robot, case.controller, case.variant) if part)
    return time_series(panels, title=title, phases=log.phases())


def _moments(case: TaskCase, made: Listed, experiment: Experiment, log: Log) -> Later | None:
    plant = experiment.plant.inner if isinstance(experiment.plant, ImperfectPlant) else experiment.plant
    frame, time = made.believed.frames[0], log.time("measurement/q")
    if not isinstance(plant, MujocoPlant) or len(time) < 2:
        return None
    place, q = log[f"truth/{frame}/position"], log["truth/q"]
    middle = 0.5 * (place.max(axis=0) + place.min(axis=0))
    x, y, z = (float(entry) for entry in 0.75 * middle)
    camera = Camera((x, y, z), distance=max(3.0 * float(np.linalg.norm(middle)), 0.8), azimuth=128.0, elevation=-18.0)
    moments = [round(share * (len(time) - 1)) for share in _SHARES]
    bodies = [log[f"truth/objects/{name}/pose"] for name, thing in case.scene.items() if thing.mass > 0.0]
    force = log[f"truth/{frame}/wrench"][:, :3] if made.believed.presses else np.zeros_like(place)
    shots = [
        Snapshot(
            np.concatenate([q[i], *(poses[min(i, len(poses) - 1)] for poses in bodies)]),
            (Path3(place[: i + 1 : 1 + i // _POINTS], _TRACE, 0.003),) if i > 1 else (),
            (Arrow(place[i], _METRES_PER_NEWTON * force[i], _FORCE),) if np.linalg.norm(force[i]) > _SHOWN else (),
        )
        for i in moments
    ]
    names = {i: next((name for begin, name in reversed(log.phases()) if begin <= time[i]), "") for i in moments}
    titles = [f"t = {time[i]:.2f} s" + (f", {names[i]}" if names[i] else "") for i in moments]
    heading = f"{case.case}, {case.robot}, {case.controller}"
    return pictures_later(
        plant.model, shots, camera, (520, 420), lambda pictures: picture_row(pictures, titles, heading, 2.6, 2.5)
    )
