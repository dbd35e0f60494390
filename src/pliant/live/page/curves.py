"""The curves on the page: which quantities, from a running loop or from a log."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pliant.live.page.task_error import motion_axes, position_error, position_errors
from pliant.signals import Tick
from pliant.simulation import Push
from pliant.spatial import Array
from pliant.telemetry.log import Log

ENERGIES = ("stored", "supplied", "delivered", "dissipated")
"""entries of the ledger, channels energy/…"""
AXES = ("x", "y", "z")
_M_TO_MM = 1e3
_S_TO_MS = 1e3


@dataclass(frozen=True, slots=True)
class Columns:
    """Names of the columns of samples, the first is the time."""

    names: tuple[str, ...]
    frame: str
    """of the first task; empty without one"""
    command_wrench: str
    """channel of the wrench that the controller asks for; empty if there is none"""
    energies: tuple[str, ...]
    live: bool
    """whether pushes and computation times are known; a log has neither"""

    @staticmethod
    def of(tick: Tick, joints: Sequence[str]) -> Columns:
        """The columns of ticks like this one."""
        frame = tick.reference.tasks[0].frame if tick.reference.tasks else ""
        return _columns(frame, tuple(tick.command.diagnostics), joints, live=True)

    def row(self, tick: Tick, pushes: Sequence[Push], control_time: float) -> list[float]:
        """One sample.

        Args:
            tick: what happened.
            pushes: that act.
            control_time: s, the longest of planning plus control since the last sample.
        """
        desired, error = _NAN3, _NAN3
        if tick.reference.tasks:
            task = tick.reference.tasks[0]
            desired = task.wrench[:3]
            actual = None if tick.truth is None else tick.truth.positions.get(task.frame)
            if actual is not None:
                error = position_error((task.position - actual) * _M_TO_MM, motion_axes(task))
        diagnostics = tick.command.diagnostics
        asked = np.asarray(diagnostics[self.command_wrench])[:3] if self.command_wrench else ()
        push = np.sum([p.force for p in pushes], axis=0) if pushes else _ZERO3
        energies = [float(np.asarray(diagnostics[f"energy/{name}"])) for name in self.energies]
        contact = contact_force(tick, self.frame)
        head = [tick.measurement.time, *contact, *asked, *desired, *push, *error]
        return [*head, *energies, *tick.command.torque.tolist(), control_time * _S_TO_MS]

    @staticmethod
    def of_log(log: Log, joints: Sequence[str]) -> tuple[Columns, Array]:
        """Columns and all samples (k, columns) of a log."""
        frames = [name.split("/")[1] for name in log.matching("/position") if name.startswith("reference/")]
        made = _columns(first_frame(log, frames), tuple(log.channels), joints, live=False)
        time = log.time("command/torque")
        f = made.frame
        contact = _channel(log, (f"estimate/{f}/wrench", f"truth/{f}/wrench"), time, 3)
        asked = _channel(log, (made.command_wrench,), time, 3) if made.command_wrench else np.empty((len(time), 0))
        desired = _channel(log, (f"reference/{f}/wrench",), time, 3)
        target = _channel(log, (f"reference/{f}/position",), time, 3)
        apart = _M_TO_MM * (target - _channel(log, (f"truth/{f}/position",), time, 3))
        error = position_errors(apart, np.nan_to_num(desired))
        energies = [_channel(log, (f"energy/{name}",), time, 1) for name in made.energies]
        parts = [time[:, None], contact, asked, desired, error]
        return made, np.hstack([*parts, *energies, log["command/torque"]])


_NAN3, _ZERO3 = np.full(3, np.nan), np.zeros(3)


def contact_force(tick: Tick, frame: str) -> Array:
    """(3,) N on the robot at a frame: estimated, or the true one where there is no estimate."""
    for signal in (tick.estimate, tick.truth):
        wrenches = {} if signal is None else signal.wrenches
        if frame in wrenches:
            force: Array = wrenches[frame][:3]
            return force
    if tick.truth is not None and tick.truth.wrenches:
        total: Array = np.sum([wrench[:3] for wrench in tick.truth.wrenches.values()], axis=0)
        return total
    return _NAN3


def first_frame(log: Log, frames: Sequence[str]) -> str:
    """The frame whose position is tracked first: one that touches things, if the log cannot say."""
    touching = [frame for frame in frames if f"truth/{frame}/wrench" in log]
    return (touching or list(frames) or [""])[0]


def _columns(frame: str, channels: Sequence[str], joints: Sequence[str], *, live: bool) -> Columns:
    wrench = next((n for n in channels if n.endswith("/wrench") and n.split("/")[0] not in _SIGNALS), "")
    energies = tuple(name for name in ENERGIES if f"energy/{name}" in channels)
    forces = ["contact", *(["commanded"] if wrench else []), "desired", *(["push"] if live else [])]
    vectors = [f"{name}.{axis}" for name in (*forces, "error") for axis in AXES]
    scalars = [*(f"energy.{name}" for name in energies), *(f"torque.{name}" for name in joints)]
    names = ("time", *vectors, *scalars, *(["control"] if live else []))
    return Columns(names, frame, wrench, energies, live)


_SIGNALS = ("measurement", "estimate", "reference", "command", "truth")


def _channel(log: Log, names: Sequence[str], time: Array, width: int) -> Array:
    """(k, width) of the first channel that the log has, at the times of the torques; NaN where it has none."""
    for name in names:
        if name and name in log:
            values = log[name].reshape(len(log.time(name)), -1)[:, :width]
            if len(values) == len(time):
                return values
            return np.column_stack([np.interp(time, log.time(name), column, left=np.nan) for column in values.T])
    return np.full((len(time), width), np.nan)
