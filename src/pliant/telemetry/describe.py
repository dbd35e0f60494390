"""Contents of a log as text: the run, its channels, and general metrics."""

from __future__ import annotations

import numpy as np
from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from pliant.telemetry import in_parts, metrics
from pliant.telemetry.log import Log
from pliant.telemetry.summary import Metric
from pliant.telemetry.table import number

_MM = 1e3  # mm per m


def describe(log: Log) -> RenderableType:
    """The contents of a log: a header, a table of channels, a table of metrics."""
    return Group(_header(log), _channels(log), _metrics(log))


def log_metrics(log: Log) -> tuple[Metric, ...]:
    """Metrics over the whole log that need no knowledge of the task.

    Returns:
        Per frame with a reference: RMSE of the position per axis (true position where the log has it), and the rms
        error of the force along the axes on which one was asked for. For the torque sent: variation, peak,
        largest change per tick, share of time in which it was clamped.
    """
    found: list[Metric] = []
    for frame in frames(log):
        found += _tracking(log, frame)
        found += _force(log, frame)
    if "command/torque" in log and log.channels["command/torque"].count > 1:
        found += _torque(log)
    return tuple(found)


def _torque(log: Log) -> list[Metric]:
    sent, limits = "command/torque", np.array(log.info.torque_limits)
    period = float(np.median(np.diff(log.time(sent))))
    variation = in_parts.of_steps(metrics.torque_variation, log.parts(sent, before=1), period)
    peak = in_parts.largest(metrics.peak(part) for (part,) in log.parts(sent))
    found = [
        Metric("torque variation", variation, "N·m/s"),
        Metric("peak torque", float(peak), "N·m"),
    ]
    if log.channels[sent].shape == limits.shape:
        step = in_parts.largest(metrics.torque_step_fraction(part, limits) for (part,) in log.parts(sent, before=1))
        found.append(Metric("torque change per tick", 100.0 * float(step), "% of limit"))
    clamped = in_parts.mean(np.any(part != 0.0, axis=1) for (part,) in log.parts("command/clamped"))
    return [*found, Metric("time at a torque limit", 100.0 * float(clamped), "%")]


def frames(log: Log) -> list[str]:
    """Frames for which the log has a reference position."""
    return [name.split("/")[1] for name in log.matching("/position") if name.startswith("reference/")]


def _tracking(log: Log, frame: str) -> list[Metric]:
    actual, reference = f"truth/{frame}/position", f"reference/{frame}/position"
    if actual not in log or log.channels[actual].count != log.channels[reference].count:
        return []
    errors = _MM * np.sqrt(in_parts.mean((a - b) ** 2 for a, b in log.parts(actual, reference)))
    return [
        Metric(f"{frame} position rmse {axis}", float(error), "mm") for axis, error in zip("xyz", errors, strict=True)
    ]


def _force(log: Log, frame: str) -> list[Metric]:
    wanted = f"reference/{frame}/wrench"
    source = next((f"{s}/{frame}/wrench" for s in ("truth", "estimate") if f"{s}/{frame}/wrench" in log), None)
    if source is None or log.channels[source].count != log.channels[wanted].count:
        return []
    asked = in_parts.largest(np.max(part[:, :3] != 0.0, axis=0) for (part,) in log.parts(wanted))
    errors = np.sqrt(in_parts.mean((a[:, :3] - b[:, :3]) ** 2 for a, b in log.parts(source, wanted)))
    return [Metric(f"{frame} force rms error {'xyz'[axis]}", errors[axis], "N") for axis in np.flatnonzero(asked)]


def _header(log: Log) -> RenderableType:
    info = log.info
    grid = Table.grid(padding=(0, 2))
    rows = [
        ("log", log.source),
        ("run", " · ".join(part for part in (info.study, info.case, info.controller) if part) or "–"),
        ("robot", info.robot or "–"),
        ("seed", "–" if info.seed is None else str(info.seed)),
        ("pliant", info.version),
        ("length", f"{log.duration:.3f} s"),
    ]
    if phases := log.phases():
        rows.append(("phases", ", ".join(f"{name or '(none)'} from {time:.3f} s" for time, name in phases)))
    for name, value in rows:
        grid.add_row(Text(name, style="bold"), value)
    if log.failure:
        grid.add_row(Text("failed", style="bold red"), Text(log.failure, style="red"))
    if log.truncated:
        grid.add_row(
            Text("cut off", style="bold red"),
            Text("the file is truncated or damaged; what could be read is shown"),
        )
    return grid


def _channels(log: Log) -> Table:
    table = Table(title="channels", title_justify="left", header_style="bold")
    table.add_column("channel", overflow="fold")
    table.add_column("shape", no_wrap=True)
    table.add_column("unit")
    table.add_column("samples", justify="right")
    table.add_column("rate, Hz", justify="right")
    table.add_column("topic", overflow="fold", style="dim")
    for channel in log.channels.values():
        shape = "×".join(map(str, channel.shape)) or "1"
        rate = f"{channel.rate:.4g}" if channel.rate else "–"
        table.add_row(channel.name, shape, channel.unit or "–", str(channel.count), rate, channel.topic)
    return table


def _metrics(log: Log) -> RenderableType:
    found = log_metrics(log)
    if not found:
        return Text("no metrics: the log has neither torques nor references", style="dim")
    table = Table(title="metrics over the whole log", title_justify="left", header_style="bold")
    table.add_column("metric")
    table.add_column("value", justify="right")
    table.add_column("unit")
    for metric in found:
        table.add_row(metric.name, number(metric.value), metric.unit)
    return table
