"""The scene of a log at any time."""

from __future__ import annotations

from dataclasses import fields

import numpy as np

from pliant.environment import Environment, EstimatedSurface
from pliant.errors import OutputError
from pliant.experiments.drawn import drawn_log
from pliant.live.link.messages import Picture
from pliant.live.page.curves import Columns
from pliant.live.page.task_error import TaskError
from pliant.signals import TaskReference
from pliant.spatial import Array
from pliant.telemetry.log import Log
from pliant.visual_shapes import Poser, looks_of

_CURVE_SAMPLES = 0.02  # s between two points of a curve


class LoggedScene:
    """The scene of a log at any time.

    Args:
        log: with torques, and true joint positions or measured ones.

    Raises:
        OutputError: the log holds no motion.
        RobotError: the robot of the log is not here.
    """

    def __init__(self, log: Log) -> None:
        if "command/torque" not in log or "measurement/q" not in log:
            raise OutputError(
                f"{log.source} holds no motion to replay: it has no channel 'measurement/q' or 'command/torque'"
            )
        self.log = log
        drawn, robot, self.scene = drawn_log(log)
        self.model = drawn.model
        self.robot = robot
        self.looks = looks_of(self.model, robot.n)
        self.columns, self.rows = Columns.of_log(log, robot.joint_names)
        self._body, self._ghost = Poser(self.model, robot.n), Poser(self.model, robot.n)
        self.time = log.time("measurement/q")
        self._q = log["truth/q" if "truth/q" in log else "measurement/q"]
        self._wrenches = {name.split("/")[1]: name for name in log.matching("/wrench") if name.startswith("truth/")}
        self._felt = [name.split("/")[1] for name in log.matching("/stiffness_std") if name.startswith("estimate/")]
        self._surfaces = [
            name.split("/")[1] for name in log.matching("/surface/normal") if name.startswith("estimate/")
        ]
        self._objects = {name.split("/")[2]: name for name in log.channels if name.startswith("truth/objects/")}

    def picture(self, at: float) -> Picture:
        """The scene at a time in s."""
        moment = float(self.time[min(int(np.searchsorted(self.time, at)), len(self.time) - 1)])
        q = self._value("truth/q" if "truth/q" in self.log else "measurement/q", moment)
        assert q is not None
        objects = {
            name: pose for name, channel in self._objects.items() if (pose := self._value(channel, moment)) is not None
        }
        positions, quaternions = self._body.bodies(q, objects)
        posture = self._value("reference/posture", moment)
        here = self._body.frame(self.columns.frame) if self.columns.frame else None
        target = self._value(f"reference/{self.columns.frame}/position", moment)
        return Picture(
            run=0,
            time=moment,
            positions=positions,
            quaternions=quaternions,
            ghost=None if posture is None else self._ghost.bodies(posture, objects),
            tool=positions[-1] if here is None else here,
            target=target,
            nominal=None,
            contacts=self._contacts(moment),
            asked=self._asked(moment),
            predicted_path=self._rows("mpc/predicted_path", moment),
            predicted_force=self._rows("mpc/predicted_force", moment),
            error=self._error(moment),
            environments=self._environments(moment),
            surfaces=self._estimated_surfaces(moment),
        )

    def curves(self, at: float, window: float) -> Array:
        """Samples (k, columns) of the last seconds before a time."""
        time = self.rows[:, 0]
        first, last = np.searchsorted(time, (at - window, at + 1e-9))
        step = max(1, round(_CURVE_SAMPLES * len(time) / max(float(time[-1] - time[0]), 1e-3)))
        return self.rows[int(first) : max(int(last), int(first) + 1) : step]

    def _value(self, channel: str, at: float) -> Array | None:
        """The latest sample of a channel at a time; None if there is none yet."""
        if channel not in self.log:
            return None
        index = int(np.searchsorted(self.log.time(channel), at + 1e-9)) - 1
        return self.log[channel][index] if index >= 0 else None

    def _rows(self, channel: str, at: float) -> Array | None:
        value = self._value(channel, at)
        return value[:, :3] if value is not None and value.ndim == 2 and np.isfinite(value).all() else None

    def _contacts(self, at: float) -> dict[str, tuple[Array, Array]]:
        found: dict[str, tuple[Array, Array]] = {}
        for frame, channel in self._wrenches.items():
            place, wrench = self._body.frame(frame), self._value(channel, at)
            if place is not None and wrench is not None:
                found[frame] = place, wrench[:3]
        return found

    def _estimated_surfaces(self, at: float) -> dict[str, EstimatedSurface]:
        found: dict[str, EstimatedSurface] = {}
        for frame in self._surfaces:
            pivot, turn, normal, std = (
                self._value(f"estimate/{frame}/surface/{part.name}", at) for part in fields(EstimatedSurface)
            )
            if pivot is not None and turn is not None and normal is not None and std is not None:
                found[frame] = EstimatedSurface(pivot, turn, normal, float(np.squeeze(std)))
        return found

    def _environments(self, at: float) -> dict[str, Environment]:
        found: dict[str, Environment] = {}
        for frame in self._felt:
            numbers = [self._value(f"estimate/{frame}/{part.name}", at) for part in fields(Environment)]
            if all(number is not None for number in numbers):
                found[frame] = Environment(*(float(np.squeeze(number)) for number in numbers if number is not None))
        return found

    def _error(self, at: float) -> TaskError | None:
        f = self.columns.frame
        names = (f"reference/{f}/position", f"reference/{f}/wrench", f"truth/{f}/position", f"truth/{f}/wrench")
        target, asked, place, wrench = (self._value(name, at) for name in names)
        if target is None or asked is None or place is None or wrench is None:
            return None
        return TaskError.of(TaskReference(f, target, wrench=asked), place, wrench[:3])

    def _asked(self, at: float) -> Array:
        for channel in (f"reference/{self.columns.frame}/wrench", self.columns.command_wrench):
            value = self._value(channel, at) if channel else None
            if value is not None and np.any(value[:3]):
                return value[:3]
        return np.zeros(3)
