"""Figures of one run of the polishing study: signals over time, and the scene ([FFMPC] Fig. 5)."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from pliant.experiments.base import Experiment
from pliant.simulation import ImperfectPlant, MujocoPlant
from pliant.simulation.snapshot import Arrow, Camera, Path3, Snapshot
from pliant.spatial import Array
from pliant.studies.figures import Later, pictures_later, saved_figures
from pliant.studies.polishing.config import PolishingConfig
from pliant.studies.polishing.paper_task import FRAME
from pliant.telemetry.log import Log
from pliant.telemetry.plots import Curve, Panel, time_series
from pliant.telemetry.plots.pictures import picture_row

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_METRES_PER_NEWTON = 0.004
_CAMERA = Camera(look_at=(0.50, 0.0, 0.24), distance=1.45, azimuth=128.0, elevation=-16.0)
_REFERENCE, _TRACE, _FORCE = (0.35, 0.55, 0.85, 1.0), (0.95, 0.45, 0.10, 1.0), (0.76, 0.18, 0.18, 1.0)


def run_figures(config: PolishingConfig, experiment: Experiment, log: Log, folder: Path) -> list[Path]:
    """Force, position error, disturbance and solver over time; the arm at four moments."""
    return saved_figures(config, folder, {"scene": _moments(config, experiment, log), "history": _history(config, log)})


def _history(config: PolishingConfig, log: Log) -> Figure:
    time = log.time(f"truth/{FRAME}/wrench")
    force, wanted = log[f"truth/{FRAME}/wrench"][:, 2], log[f"reference/{FRAME}/wrench"][:, 2]
    error = 1e3 * (log[f"truth/{FRAME}/position"] - log[f"reference/{FRAME}/position"])
    panels = [
        Panel("normal force, N", [Curve("true", time, force), Curve("reference", time, wanted, "reference")]),
        Panel("position error, mm", [Curve("xy"[axis], time, error[:, axis]) for axis in range(2)]),
    ]
    if "mpc/disturbance" in log and np.any(log["mpc/disturbance"]):
        disturbance = log["mpc/disturbance"]
        curves = [Curve(f"joint {joint + 1}", time, values) for joint, values in enumerate(disturbance.T)]
        panels.append(Panel("disturbance, N·m", curves))
    if "mpc/iterations" in log:
        panels.append(Panel("SQP iterations", [Curve("", log.time("mpc/iterations"), log["mpc/iterations"])]))
    title = " · ".join(part for part in (config.case, config.controller, config.variant) if part)
    return time_series(panels, title=title, phases=log.phases())


def _moments(config: PolishingConfig, experiment: Experiment, log: Log) -> Later | None:
    """Reach, first contact, ramp, circle: the arm with what the tool has drawn so far and the force it feels."""
    plant = experiment.plant.inner if isinstance(experiment.plant, ImperfectPlant) else experiment.plant
    time, q = log.time("truth/q"), log["truth/q"]
    task = config.task
    instants = [0.5 * task.reach, task.touch + 0.05, task.circle, 0.5 * (task.circle + config.duration)]
    instants = [instant for instant in instants if instant <= time[-1]]
    if not isinstance(plant, MujocoPlant) or not instants:
        return None
    moments = np.searchsorted(time, instants)
    shots = [_snapshot(log, q, int(moment)) for moment in moments]
    force = log[f"truth/{FRAME}/wrench"][:, 2]
    titles = [f"t = {time[moment]:.2f} s, {force[moment]:.0f} N" for moment in moments]
    heading = f"{config.case}, {config.controller}"
    return pictures_later(
        plant.model, shots, _CAMERA, (520, 420), lambda pictures: picture_row(pictures, titles, heading, 2.6, 2.5)
    )


def _snapshot(log: Log, q: Array, moment: int) -> Snapshot:
    position = log[f"truth/{FRAME}/position"]
    drawn, wanted = position[: moment + 1 : 10], log[f"reference/{FRAME}/position"][: moment + 1 : 10]
    beside = position[moment] + np.array([0.06, 0.0, 0.0])  # where the tool does not hide it
    force = log[f"truth/{FRAME}/wrench"][moment, :3]
    arrows = (Arrow(beside, _METRES_PER_NEWTON * force, _FORCE),) if force.any() else ()
    paths = (Path3(wanted, _REFERENCE, 0.003), Path3(drawn, _TRACE, 0.003)) if len(drawn) > 1 else ()
    return Snapshot(q[moment], paths, arrows)
