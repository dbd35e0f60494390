"""General figures of a log."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from pliant.telemetry.describe import frames
from pliant.telemetry.log import Log
from pliant.telemetry.output import output_folder
from pliant.telemetry.plots import style
from pliant.telemetry.plots.joints import joint_torques, posture_difference
from pliant.telemetry.plots.path import Path2D, task_path
from pliant.telemetry.plots.series import Curve, Panel, time_series

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_MM = 1e3  # mm per m


def plot_log(log: Log, out: Path) -> list[Path]:
    """Draws what a log holds: per frame its position error, path and forces; torques, posture, energies.

    Args:
        log: any log of pliant.
        out: folder for the PNG files; it is made if need be.

    Returns:
        The files written.

    Raises:
        OutputError: the folder or a file cannot be written.
    """
    folder = output_folder(out)
    return [style.save(made, folder / f"{name}.png") for name, made in figures(log).items()]


def figures(log: Log) -> dict[str, Figure]:
    """The same figures by name, not written. Channels that a log lacks leave their figure out."""
    title = " · ".join(part for part in (log.info.study, log.info.case, log.info.controller) if part)
    found: dict[str, Figure] = {}
    for frame in frames(log):
        found |= _frame(log, frame, f"{title} · {frame}" if title else frame)
    if "command/torque" in log:
        channel = log.channels["command/torque"]
        time, torque = log.time("command/torque"), log["command/torque"]
        limits = np.array(log.info.torque_limits) if len(log.info.torque_limits) == torque.shape[1] else None
        found["torques"] = joint_torques(time, torque, limits, channel.labels, title, log.phases())
    if "reference/posture" in log and log["reference/posture"].shape == log["measurement/q"].shape:
        q = log["truth/q"] if "truth/q" in log else log["measurement/q"]
        names = log.channels["measurement/q"].labels
        found["posture"] = posture_difference(log.time("reference/posture"), q, log["reference/posture"], names, title)
    energies = [c.name for c in log.channels.values() if c.unit == "J" and c.shape == ()]
    if energies:
        panels = [
            Panel(
                "energy, J",
                [
                    Curve(n.rpartition("/")[2].removeprefix("energy_"), log.time(n), log[n])
                    for n in energies
                    if n.startswith(base)
                ],
                base,
            )
            for base in dict.fromkeys(name.rpartition("/")[0] for name in energies)
        ]
        found["energy"] = time_series(panels, title, log.phases())
    return found


def _frame(log: Log, frame: str, title: str) -> dict[str, Figure]:
    found: dict[str, Figure] = {}
    actual, reference = f"truth/{frame}/position", f"reference/{frame}/position"
    time = log.time(reference)
    if actual in log and log[actual].shape == log[reference].shape:
        error = (log[reference] - log[actual]) * _MM
        panels = [
            Panel(f"{axis}: error, mm", [Curve("", time, error[:, i])], least_height=0.1)
            for i, axis in enumerate("xyz")
        ]
        found[f"{frame}_error"] = time_series(panels, title, log.phases())
        plane = _plane(np.concatenate((log[reference], log[actual])))
        found[f"{frame}_path"] = task_path([Path2D("actual", log[actual])], log[reference], plane, title, by_error=True)
    panels = [_force_panel(log, frame, axis) for axis in range(3)]
    if any(len(panel.curves) > 1 for panel in panels):
        found[f"{frame}_force"] = time_series(panels, title, log.phases())
    return found


def _force_panel(log: Log, frame: str, axis: int) -> Panel:
    wanted = f"reference/{frame}/wrench"
    curves = [Curve("desired", log.time(wanted), log[wanted][:, axis], "reference")]
    for signal, label, kind in (("truth", "true", "actual"), ("estimate", "estimated", "faint")):
        name = f"{signal}/{frame}/wrench"
        if name in log:
            curves.append(Curve(label, log.time(name), log[name][:, axis], kind))
    return Panel(f"{'xyz'[axis]}: force, N", curves, least_height=0.5)


def _plane(points: np.ndarray) -> tuple[int, int]:
    """The two world axes along which a path and its reference extend most; horizontal ones first."""
    spans = np.nanmax(points, axis=0) - np.nanmin(points, axis=0)
    first, second = sorted(np.argsort(-spans, kind="stable")[:2].tolist())
    return first, second
