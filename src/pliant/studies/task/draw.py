"""Figures of a task's run: signals over time, and the robot on its part."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from pliant.experiments.base import Experiment, Result
from pliant.experiments.drawn import simulated
from pliant.simulation import ImperfectPlant, MujocoPlant
from pliant.simulation.snapshot import Arrow, Camera, Path3, Snapshot
from pliant.spatial import Array
from pliant.studies.figures import Later, pictures_later, saved_figures
from pliant.studies.task.config import TaskCase
from pliant.studies.task.measure import TaskSignals
from pliant.surfaces.unroll import unrolled
from pliant.telemetry.log import Log
from pliant.telemetry.plots import Curve, Panel, save, time_series
from pliant.telemetry.plots.path import coloured_path
from pliant.telemetry.plots.pictures import picture_row
from pliant.telemetry.plots.rows import dots

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_METRES_PER_NEWTON = 0.004
_REFERENCE, _TRACE, _FORCE = (0.35, 0.55, 0.85, 1.0), (0.95, 0.45, 0.10, 1.0), (0.76, 0.18, 0.18, 1.0)
_SHARES = (0.02, 0.35, 0.65, 0.98)
"""of the path, at which the robot is drawn"""
_EVERY = 10
"""samples: of a map one dot"""


def run_figures(case: TaskCase, experiment: Experiment, log: Log, signals: TaskSignals, folder: Path) -> list[Path]:
    """Force and distance from the path over time; force error along the way; the robot at four moments."""
    follows = np.count_nonzero(signals.following) > 2 * _EVERY
    figures = {
        "scene": _moments(case, experiment, log, signals),
        "history": _history(case, experiment, log, signals),
        "map": _map(case, signals) if follows else None,
    }
    return saved_figures(case, folder, figures)


def comparison(results: Sequence[Result], folder: Path) -> list[Path]:
    """What several runs say together: a dot for each, a row for each case, robot, controller and variant."""
    if len(results) < 2:
        return []
    files: list[Path] = []
    for name, label in (("force_error", "mean force error, N"), ("path_error", "mean distance from the path, mm")):
        rows: dict[str, list[float]] = {}
        bounds: dict[str, float] = {}
        for result in results:
            config = result.config
            row = " · ".join(part for part in (config.case, config.robot, config.controller, config.variant) if part)
            found = next((one for one in result.metrics if one.name == name), None)
            rows.setdefault(row, []).append(np.nan if found is None or result.failure else found.value)
            if found is not None and found.target is not None:
                bounds[row] = found.target
        drawn = {row: np.array(values) for row, values in rows.items()}
        files.append(save(dots(drawn, label, targets=bounds), folder / f"compare_{name}.png"))
    return files


def _history(case: TaskCase, experiment: Experiment, log: Log, signals: TaskSignals) -> Figure:
    time = signals.time
    error = np.where(signals.following, signals.force - signals.wanted, np.nan)
    panels = [
        Panel(
            "normal force, N", [Curve("true", time, signals.force), Curve("asked", time, signals.wanted, "reference")]
        ),
        Panel("force error on the path, N", [Curve("", time, error)]),
        Panel("distance from the path, mm", [Curve("", time, 1e3 * signals.beside)]),
        Panel("largest torque, % of its limit", [Curve("", time, 100.0 * signals.limit.max(axis=1))]),
    ]
    stiffness = _stiffness(case, experiment, log, signals.time)
    panels += [Panel("stiffness, kN/m", stiffness)] if stiffness else []
    return time_series(panels, title=_title(case), phases=log.phases())


def _stiffness(case: TaskCase, experiment: Experiment, log: Log, time: Array) -> list[Curve]:
    """Of the surface where the tool is, and as it is estimated, while it is; none: it is the same everywhere."""
    plant, frame = simulated(experiment.plant), case.tool.frame
    change = None if plant is None else next((one.surface.change for one in plant.scene.things), None)
    if change is None:
        return []
    along = (log[f"truth/{frame}/position"] - np.array(change.origin)) @ np.array(change.direction)
    curves = [Curve("true", time, 1e-3 * np.interp(along, change.places, change.stiffness))]
    name = f"estimate/{frame}/stiffness"
    if name in log.channels:
        known = np.full(len(time), np.nan)
        known[np.searchsorted(time, log.time(name) - 1e-9)] = 1e-3 * log[name].ravel()
        curves.append(Curve("estimated", time, known))
    return curves


def _map(case: TaskCase, signals: TaskSignals) -> Figure:
    """Force error as colour along the way on the surface, which is laid flat."""
    on = np.flatnonzero(signals.following)[::_EVERY]
    error = signals.force[on] - signals.wanted[on]
    return coloured_path(unrolled(signals.place[on], signals.normal[on]), error, "force error, N", _title(case))


def _title(case: TaskCase) -> str:
    return " · ".join(part for part in (case.case, case.robot, case.controller, case.variant) if part)


def _moments(case: TaskCase, experiment: Experiment, log: Log, signals: TaskSignals) -> Later | None:
    plant = experiment.plant.inner if isinstance(experiment.plant, ImperfectPlant) else experiment.plant
    on_path = np.flatnonzero(signals.following)
    if not isinstance(plant, MujocoPlant) or on_path.size < 2:
        return None
    moments = [int(on_path[round(share * (on_path.size - 1))]) for share in _SHARES]
    q, frame = log["truth/q"], case.tool.frame
    place = log[f"truth/{frame}/position"]
    middle = 0.5 * (place[on_path].max(axis=0) + place[on_path].min(axis=0))
    camera = Camera(
        look_at=(float(0.75 * middle[0]), float(0.75 * middle[1]), float(middle[2]) + 0.2),
        distance=1.5,
        azimuth=128.0,
        elevation=-18.0,
    )
    shots = [_snapshot(log, q, frame, on_path, moment) for moment in moments]
    time, force, wanted = signals.time, signals.force, signals.wanted
    titles = [f"t = {time[i]:.2f} s, {force[i]:.1f} of {wanted[i]:.1f} N" for i in moments]
    heading = f"{case.case}, {case.robot}, {case.controller}"
    return pictures_later(
        plant.model, shots, camera, (520, 420), lambda pictures: picture_row(pictures, titles, heading, 2.6, 2.5)
    )


def _snapshot(log: Log, q: Array, frame: str, on_path: npt.NDArray[np.intp], moment: int) -> Snapshot:
    position = log[f"truth/{frame}/position"]
    first = int(on_path[0])
    drawn = position[first : moment + 1 : 10]
    wanted = log[f"reference/{frame}/position"][first : int(on_path[-1]) : 10]
    force = log[f"truth/{frame}/wrench"][moment, :3]
    arrows = (Arrow(position[moment], _METRES_PER_NEWTON * force, _FORCE),) if force.any() else ()
    paths = (Path3(wanted, _REFERENCE, 0.002), Path3(drawn, _TRACE, 0.003)) if len(drawn) > 1 else ()
    return Snapshot(q[moment], paths, arrows)
