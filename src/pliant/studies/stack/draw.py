"""Figures of the stack study: [Stack] Figs. 3 to 10 from our own runs."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from pliant.controllers.attractor import Attractor, Law
from pliant.controllers.profiles import ForceProfile
from pliant.experiments.base import Experiment, Result
from pliant.signals import ImpedanceTuning
from pliant.simulation import MujocoPlant
from pliant.simulation.snapshot import Camera, Path3, Snapshot
from pliant.spatial import Array
from pliant.studies.figures import Later, pictures_later, saved_figures
from pliant.studies.stack.config import StackCaseConfig
from pliant.telemetry.log import Log
from pliant.telemetry.plots import (
    Path2D,
    attractor,
    compare,
    energy_ledger,
    joint_torques,
    posture_difference,
    save,
    style,
    task_path,
)
from pliant.telemetry.summary import Metric

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_REFERENCE, _ACTUAL = (0.35, 0.55, 0.85, 1.0), (0.95, 0.45, 0.10, 1.0)
_CAMERA = Camera(look_at=(0.0, -0.30, 0.34), distance=1.35, azimuth=28.0, elevation=-12.0)


def run_figures(config: StackCaseConfig, experiment: Experiment, log: Log, folder: Path) -> list[Path]:
    """Posture difference, tool path, torques (the three panels of [Stack] Figs. 5 to 10), energies and the scene."""
    tool = config.frames()[0]
    time = log.time("measurement/q")
    title = " · ".join(part for part in (config.case, config.controller, config.variant) if part)
    names = experiment.robot.joint_names
    actual, reference = log[f"truth/{tool}/position"], log[f"reference/{tool}/position"]
    plane = (1, 2) if config.path.kind == "stretch" else (0, 2)
    wall = config.wall.x if config.wall is not None else None
    figures: dict[str, Figure | Later | None] = {
        "scene": _scene(config, experiment, log, tool),
        "path": task_path([Path2D("actual", actual)], reference, plane, f"Tool path · {title}", wall, by_error=True),
        "posture": posture_difference(
            time, log["truth/q"], log["reference/posture"], names, f"Posture off its reference · {title}"
        ),
        "torque": joint_torques(
            time, log["command/torque"], experiment.robot.torque_limit, names, f"Joint torques · {title}"
        ),
    }
    if "energy/stored" in log:
        entries = {name: log[f"energy/{name}"] for name in ("stored", "supplied", "dissipated", "clamped")}
        margin = log["ee/storage_margin"][:, :3].min(axis=1)
        figures["energy"] = energy_ledger(time, entries, margin, f"Energy ledger · {title}")
    return saved_figures(config, folder, figures)


def _scene(config: StackCaseConfig, experiment: Experiment, log: Log, tool: str) -> Later | None:
    """The arm at four instants (solid) over its reference posture (pale), with both traces ([Stack] Fig. 4)."""
    if not isinstance(experiment.plant, MujocoPlant):
        return None
    time, q = log.time("measurement/q"), log["truth/q"]
    moments = np.searchsorted(time, config.settled + config.path.period * np.array([0.0, 0.125, 0.375, 0.625]))
    moments = np.minimum(moments, len(time) - 1)
    counts = time >= config.settled
    paths = tuple(
        Path3(_thinned(log[f"{signal}/{tool}/position"][counts]), colour, 0.004)
        for signal, colour in (("reference", _REFERENCE), ("truth", _ACTUAL))
    )
    solid = [Snapshot(q[i], paths) for i in moments]
    ghost = [Snapshot(log["reference/posture"][i], paths) for i in moments]

    def drawn(pictures: Sequence[Array]) -> Figure:
        both = [0.72 * a + 0.28 * b for a, b in zip(pictures[:4], pictures[4:], strict=True)]
        return _strip(both, time[moments], config.case)

    return pictures_later(experiment.plant.model, [*solid, *ghost], _CAMERA, (600, 520), drawn)


def _strip(pictures: Sequence[Array], times: Array, title: str) -> Figure:
    made = style.figure(10.4, 2.9, f"{title}: reference blue and pale, actual orange and solid")
    for ax, picture, time in zip(made.subplots(1, len(pictures)), pictures, times, strict=True):
        ax.imshow(picture.astype(np.uint8))
        ax.set_axis_off()
        ax.set_title(f"t = {time:.2f} s", fontsize=style.NORMAL, color=style.INK)
    return made


def _thinned(points: Array, most: int = 400) -> Array:
    return points[:: max(1, len(points) // most)]


# ---------------------------------------------------------------------- figures of several runs


def summary_figures(results: Sequence[Result], folder: Path) -> list[Path]:
    """The attractor, and the RMSE of every case beside the paper's."""
    files = [save(attractor_figure(), folder / "attractor.png")]
    main = [r for r in results if r.config.controller == "stack" and not r.config.variant and r.metrics]
    if groups := _rmse_groups(main):
        files.append(
            save(
                compare(groups, "RMSE, mm", "Tracking error: pliant (bars), paper (diamonds), target (lines)"),
                folder / "rmse.png",
            )
        )
    return files


def _rmse_groups(results: Sequence[Result]) -> dict[str, list[Metric]]:
    groups: dict[str, list[Metric]] = {}
    for result in results:
        errors = [m for m in result.metrics if m.name in ("RMSE x", "RMSE y", "RMSE z") and m.paper is not None]
        if errors and result.config.seed == 0:
            groups.setdefault(result.config.case, errors)
    return groups


def attractor_figure() -> Figure:
    """Force, energy and phase portrait of one axis: [Stack] Fig. 3, with a 2 kg mass and no damping anywhere.

    Fig. 3a has the attractor of a constant spring, here of the same stiffness: it is linear as far as it is drawn.
    """
    linear = ForceProfile.of(ImpedanceTuning(*(np.array([x]) for x in (500.0, 500.0, 1.0, 0.9))))
    tuning = ImpedanceTuning(*(np.array([x]) for x in (500.0, 100.0, 0.3, 0.1)))
    profile = ForceProfile.of(tuning)
    error = np.linspace(-0.4, 0.4, 801)
    forces = {"diverging": profile.force(error[:, None])[:, 0]}
    forces["converging from 0.3 m"] = _converging(profile, error)
    energies = {"stored": profile.energy(error[:, None])[:, 0]}
    portraits = {
        "capped law": [_trajectory(profile, Law.CAPPED, x) for x in (0.1, 0.2, 0.3, -0.15, -0.3)],
        "capped law, constant spring": [_trajectory(linear, Law.CAPPED, x) for x in (0.25, -0.25)],
        "plain spring": [_trajectory(profile, Law.SPRING, 0.35)],
    }
    return attractor(error, forces, energies, portraits, "Fractal attractor of one axis")


def _converging(profile: ForceProfile, error: Array) -> Array:
    from pliant.controllers.attractor import converging_force

    values = np.full(error.shape, np.nan)
    inside = (error >= 0.0) & (error <= 0.3)
    turning = np.full((int(inside.sum()), 1), 0.3)
    values[inside] = converging_force(Law.CAPPED, profile, error[inside, None], turning)[:, 0]
    return values


def _trajectory(
    profile: ForceProfile, law: Law, start: float, mass: float = 2.0, period: float = 1e-3
) -> tuple[Array, Array]:
    """Error and its rate of a free mass released at an error."""
    attract = Attractor(period, np.array([0.5e-3]), law)
    x, v = start, 0.0
    state = attract.init(np.array([x]))
    path: list[tuple[float, float]] = []
    for _ in range(1500):
        force, state = attract.step(profile, np.array([x]), state)
        v -= float(force[0]) / mass * period
        x += v * period
        path.append((x, v))
    positions, rates = np.array(path).T
    return positions, rates
