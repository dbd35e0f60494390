"""Figures of the haptic study: [HapFIC] Figs. 4 to 8 from our own runs."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from pliant.experiments.base import Experiment
from pliant.simulation import ImperfectPlant, MujocoPlant
from pliant.simulation.snapshot import Arrow, Camera, Path3, Snapshot
from pliant.spatial import Array
from pliant.studies.figures import Later, pictures_later, saved_figures
from pliant.studies.haptic.config import HapticCaseConfig
from pliant.studies.haptic.measure import HapticSignals
from pliant.telemetry.log import Log
from pliant.telemetry.plots import Curve, Panel, time_series
from pliant.telemetry.plots.pictures import picture_row

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_FORCE, _TRACE = (0.76, 0.18, 0.18, 1.0), (0.95, 0.45, 0.10, 0.8)
_METRES_PER_NEWTON = 0.0025
_CAMERA = Camera(look_at=(0.10, 0.0, 0.25), distance=1.15, azimuth=118.0, elevation=-12.0)


def run_figures(config: HapticCaseConfig, experiment: Experiment, log: Log, folder: Path) -> list[Path]:
    """Forces, positions and commands over time ([HapFIC] Figs. 5 to 8), and the scene at its salient moments."""
    return saved_figures(config, folder, {"scene": moments(config, experiment, log), "history": history(config, log)})


def history(config: HapticCaseConfig, log: Log) -> Figure:
    """Force, position and command of every axis, and the offset of the exploration."""
    signals = HapticSignals.of(config, log)
    time, offset = signals.time, signals.explored("offset")
    panels = [_forces(signals, axis) for axis in _shown(signals)]
    for axis in range(3):
        curves = [
            Curve("planned", time, 1e3 * (signals.reference - offset)[:, axis], "reference"),
            Curve("explored", time, 1e3 * signals.reference[:, axis], "faint"),
            Curve("actual", time, 1e3 * signals.position[:, axis]),
        ]
        panels.append(Panel(f"{'xyz'[axis]}, mm", curves, least_height=2.0))
    command = signals.channel("foot/force", (3,))
    panels.append(Panel("command, N", [Curve(axis, time, command[:, i]) for i, axis in enumerate("xyz")]))
    panels.append(
        Panel("Δx, mm", [Curve(axis, time, 1e3 * offset[:, i]) for i, axis in enumerate("xyz")], least_height=2.0)
    )
    return time_series(panels, title(config), log.phases())


def title(config: HapticCaseConfig) -> str:
    """For people."""
    return " · ".join(part for part in (config.case, config.controller, config.variant) if part)


def _shown(signals: HapticSignals) -> list[int]:
    """Axes along which a force was wanted or felt."""
    felt = np.max(np.abs(signals.force), axis=0) > 0.5
    wanted = np.any(signals.wanted != 0.0, axis=0)
    return [axis for axis in range(3) if felt[axis] or wanted[axis]] or [2]


def _forces(signals: HapticSignals, axis: int) -> Panel:
    curves = [
        Curve("desired", signals.time, signals.wanted[:, axis], "reference"),
        Curve("true", signals.time, signals.force[:, axis]),
    ]
    return Panel(f"force {'xyz'[axis]}, N", curves, least_height=2.0)


def moments(config: HapticCaseConfig, experiment: Experiment, log: Log) -> Later | None:
    """The leg at its salient moments, with the foot's trace and the contact force ([HapFIC] Fig. 4)."""
    plant = experiment.plant
    if isinstance(plant, ImperfectPlant):
        plant = plant.inner
    if not isinstance(plant, MujocoPlant) or not config.snapshots:
        return None
    signals = HapticSignals.of(config, log)
    indices = np.minimum(np.searchsorted(signals.time, config.snapshots), len(signals.time) - 1)
    shots = [_snapshot(signals, plant, int(index)) for index in indices]
    titles = [f"t = {signals.time[index]:.2f} s" for index in indices]
    heading = f"{title(config)}: trace of the foot orange, contact force red"
    return pictures_later(
        plant.model, shots, _CAMERA, (520, 560), lambda pictures: picture_row(pictures, titles, heading, 2.1, 2.7)
    )


def _snapshot(signals: HapticSignals, plant: MujocoPlant, index: int) -> Snapshot:
    qpos = np.zeros(plant.model.nq)
    qpos[: plant.robot.n] = signals.log["truth/q"][index]
    for name in (body for body in ("box", "ball") if f"truth/objects/{body}/pose" in signals.log):
        start = int(plant.model.joint(name).qposadr[0])
        qpos[start : start + 7] = signals.log[f"truth/objects/{name}/pose"][index]
    trace = signals.position[: index + 1]
    paths = (Path3(_thinned(trace), _TRACE, 0.003),) if index > 1 else ()
    force = _METRES_PER_NEWTON * signals.force[index]
    arrows = (Arrow(signals.position[index], force, _FORCE),) if np.linalg.norm(force) > 0.005 else ()
    return Snapshot(qpos, paths, arrows)


def _thinned(points: Array, most: int = 300) -> Array:
    return points[:: max(1, len(points) // most)]
