"""The guard at the border of every part of the loop: what is not a sound signal reaches no law and no robot.

It looks at each measurement, estimate, reference and command. A tick whose signals are sound passes unchanged. In one
whose signals are not, no part is stepped any further; the guard answers itself: the first such tick holds the last
torque that was sent, the following ones compensate gravity with joint damping, within the limits. Once this has lasted
`PATIENCE`, the run ends as failed. The kind of fault is in `Tick.guard`, in the log as `guard/fault`.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from enum import IntEnum

import numpy as np
import pinocchio as pin

from pliant.errors import RunFailedError, ShapeError, SignalError
from pliant.interfaces import Plant
from pliant.robot import Robot
from pliant.signals import Command, Estimate, Measurement, Reference
from pliant.spatial import Array

PATIENCE = 0.05  # s of faults in a row after which the run ends
_DAMPING = 5.0  # N·m s/rad of each joint while the guard answers
_FROZEN = 3  # equal readings in a row of a sensor whose noise says that no two are equal
_LATE = 1.5  # periods between two readings from which the second one is late
_ROUNDING = 1e-9  # of a torque limit; what more is beyond it is cut off and shown


class Fault(IntEnum):
    """What was wrong in a tick: the values of the channel `guard/fault`."""

    NONE = 0
    NOT_FINITE = 1
    """a measurement with NaN or an infinite number"""
    SHAPE = 2
    """a measurement of another size than before"""
    BACKWARD = 3
    """a measurement older than the last one"""
    STALE = 4
    """a measurement as old as the last one"""
    LATE = 5
    """a measurement half a period or more later than it should be; time goes on from it"""
    FROZEN = 6
    """a third equal reading in a row of a sensor that is noisy"""
    ESTIMATE = 7
    """an estimate that is not finite, of another size, or no estimate at all"""
    REFERENCE = 8
    """a reference that is not finite, or none at all"""
    COMMAND = 9
    """a torque that is not finite, of another size, or none at all"""
    BEYOND_LIMIT = 10
    """a torque beyond the robot's limits, which was cut off; what was cut off is in `Command.clamped`"""

    @property
    def words(self) -> str:
        """For people."""
        return _WORDS[self]


_WORDS = {
    Fault.NONE: "nothing was wrong",
    Fault.NOT_FINITE: "a measurement was not finite",
    Fault.SHAPE: "a measurement had another size than before",
    Fault.BACKWARD: "a measurement was older than the last one",
    Fault.STALE: "no new measurement came",
    Fault.LATE: "measurements came late",
    Fault.FROZEN: "a noisy sensor gave the same reading again and again",
    Fault.ESTIMATE: "the estimate was not finite or of another size",
    Fault.REFERENCE: "the reference was not finite",
    Fault.COMMAND: "the controller's torque was not finite or of another size",
    Fault.BEYOND_LIMIT: "the controller's torque was beyond the limits",
}


@dataclass(slots=True)
class Watched:
    """What the guard remembers. Consumed by its methods."""

    reading: Measurement
    """the last sound one"""
    torque: Array
    """(n,) the last torque sent, N·m"""
    wrenches: tuple[str, ...]
    """frames of the force sensors"""
    equal: dict[str, int]
    """signal → how many readings in a row were equal to the one before"""
    faults: int = 0
    """ticks in a row with a fault, up to now"""
    missed: int = 0
    """ticks since the last sound reading"""
    seen: bool = False
    """whether a reading has passed"""
    last: dict[str, bytes] = field(default_factory=dict[str, bytes])
    """signal → the last reading of a noisy sensor, sound or not"""


class Guard:
    """Checks the signals of one loop.

    Args:
        plant: says its period, which of its sensors are noisy, and what it compensates by itself.
        robot: for limits and gravity. None: no limits are known, and the last torque is held instead of gravity's.
    """

    def __init__(self, plant: Plant[object], robot: Robot | None = None) -> None:
        self._plant, self._robot = plant, robot
        self._data = None if robot is None else robot.model.createData()

    def init(self, measurement: Measurement) -> Watched:
        """Checks the first measurement, before anything is computed from it.

        Raises:
            ShapeError: it does not fit the robot.
            SignalError: it is not finite.
        """
        n = measurement.q.shape[0] if self._robot is None else self._robot.n
        for name in ("q", "v", "torque", "torque_sent"):
            value = getattr(measurement, name)
            if np.shape(value) != (n,):
                raise ShapeError(f"the first measurement's {name} must have shape ({n},), got {np.shape(value)}")
        if self._measurement_is_broken(measurement):
            raise SignalError(f"a measurement was not finite at t = {measurement.time:.4f} s, the first one")
        sent = self._within(np.array(measurement.torque_sent))
        return Watched(measurement, sent, tuple(measurement.wrenches), dict.fromkeys(self._plant.noisy, 0))

    # ------------------------------------------------------------------ signals

    def measurement(self, reading: Measurement, watched: Watched) -> Fault:
        """What is wrong with a measurement."""
        before = watched.reading
        if not (len(reading.q) == len(reading.v) == len(reading.torque) == len(reading.torque_sent) == len(before.q)):
            return Fault.SHAPE
        if tuple(reading.wrenches) != watched.wrenches:
            return Fault.SHAPE
        if self._measurement_is_broken(reading):
            return Fault.NOT_FINITE
        frozen = self._frozen(reading, watched)
        if watched.seen:
            step = reading.time - before.time
            if step <= 0.0:
                return Fault.STALE if step == 0.0 else Fault.BACKWARD
            if step > (watched.missed + _LATE) * self._plant.period:
                return Fault.LATE
        watched.seen, watched.reading, watched.missed = True, reading, 0
        return Fault.FROZEN if frozen else Fault.NONE

    def estimate(self, estimate: Estimate, n: int) -> Fault:
        """What is wrong with an estimate of n joints."""
        if not isinstance(estimate, Estimate):  # pyright: ignore[reportUnnecessaryIsInstance] (somebody's own part)
            return Fault.ESTIMATE
        parts = (estimate.q, estimate.v, estimate.torque, estimate.torque_sent)
        more = () if estimate.disturbance is None else (estimate.disturbance,)
        sound = _of_size(n, parts) and _of_size(n, more) and _of_size(6, estimate.wrenches.values())
        return Fault.NONE if sound and math.isfinite(estimate.time) else Fault.ESTIMATE

    def reference(self, reference: Reference) -> Fault:
        """What is wrong with a reference."""
        if not isinstance(reference, Reference):  # pyright: ignore[reportUnnecessaryIsInstance] (somebody's own part)
            return Fault.REFERENCE
        for task in reference.tasks:
            if not (_of_size(3, (task.position,)) and _of_size(6, (task.velocity, task.acceleration, task.wrench))):
                return Fault.REFERENCE
            if not _finite(part for part in (task.rotation, task.task_rotation) if part is not None):
                return Fault.REFERENCE
        if reference.posture is not None and not _finite((reference.posture,)):
            return Fault.REFERENCE
        ahead = reference.preview
        if ahead is None:
            return Fault.NONE
        sound = _finite((ahead.time, ahead.position, ahead.rotation, ahead.velocity, ahead.wrench))
        more = (part for part in (ahead.posture, ahead.task_rotation) if part is not None)
        return Fault.NONE if sound and _finite(more) else Fault.REFERENCE

    def command(self, command: Command, n: int) -> tuple[Command, Fault]:
        """A sound command within the limits, and what was wrong; with Fault.COMMAND it may not be used."""
        if not isinstance(command, Command) or not _of_size(n, (command.torque,)):  # pyright: ignore[reportUnnecessaryIsInstance] (somebody's own part)
            return command, Fault.COMMAND
        within, clamped = self._within(command.torque), command.clamped
        if not _of_size(n, (clamped,)):
            clamped = np.zeros(n)
        if within is command.torque:
            return command if clamped is command.clamped else replace(command, clamped=clamped), Fault.NONE
        return replace(command, torque=within, clamped=clamped + command.torque - within), Fault.BEYOND_LIMIT

    def settled(self, command: Command, fault: Fault, reading: Measurement, watched: Watched) -> Command:
        """The command that is sent.

        Args:
            command: of this tick; after a fault, the last one that was sound.
            fault: of this tick.
            reading: of this tick, sound or not.
            watched: what the guard remembers.

        Raises:
            RunFailedError: faults have lasted for `PATIENCE`.
        """
        if fault in (Fault.NONE, Fault.BEYOND_LIMIT):
            watched.torque, watched.faults = command.torque, 0
            return command
        period = self._plant.period
        watched.faults += 1
        if watched.faults * period > PATIENCE + 0.5 * period:
            raise RunFailedError(f"{fault.words}; no sound signal came for {1e3 * PATIENCE:g} ms, so the run ended")
        if watched.faults > 1:
            watched.torque = self._gravity_and_damping(watched)
        watched.missed += 1
        if fault is Fault.LATE:
            watched.reading, watched.missed = reading, 0  # sound in itself: time goes on from it
        time = reading.time if math.isfinite(reading.time) else watched.reading.time
        return Command(time, watched.torque, np.zeros(len(watched.torque)), command.diagnostics)

    # ------------------------------------------------------------------ inside

    def _within(self, torque: Array) -> Array:
        """The torque itself if it keeps the limits, else what is left of it."""
        if self._robot is None:
            return torque
        limit = self._robot.torque_limit
        if (np.abs(torque) <= limit * (1.0 + _ROUNDING)).all():
            return torque
        return np.clip(np.nan_to_num(torque, nan=0.0), -limit, limit)

    def _gravity_and_damping(self, watched: Watched) -> Array:
        """(n,) N·m at the last sound reading."""
        if self._robot is None or self._data is None:
            return watched.torque
        reading = watched.reading
        torque = -_DAMPING * reading.v
        if self._plant.compensates == "none":
            torque = torque + pin.computeGeneralizedGravity(self._robot.model, self._data, reading.q)
        return self._within(torque)

    def _measurement_is_broken(self, reading: Measurement) -> bool:
        sound = math.isfinite(reading.time) and _finite((reading.q, reading.v, reading.torque, reading.torque_sent))
        return not (sound and _of_size(6, reading.wrenches.values()))

    def _frozen(self, reading: Measurement, watched: Watched) -> bool:
        """Whether a noisy sensor has given equal readings for too long."""
        frozen = False
        for name in self._plant.noisy:
            now = _signal(reading, name)
            count = watched.equal[name] = watched.equal.get(name, 0) + 1 if now == watched.last.get(name) else 0
            watched.last[name] = now
            frozen = frozen or count >= _FROZEN - 1
        return frozen


def _signal(reading: Measurement, name: str) -> bytes:
    if name == "wrenches":
        return b"".join([wrench.tobytes() for wrench in reading.wrenches.values()])
    value: Array = getattr(reading, name)
    return value.tobytes()


def _of_size(size: int, arrays: Iterable[Array]) -> bool:
    """Whether every array is a finite vector of that size."""
    for array in arrays:
        try:
            if array.shape != (size,) or not math.isfinite(array.dot(array)):
                return False
        except (AttributeError, TypeError, ValueError):  # not an array of numbers
            return False
    return True


def _finite(arrays: Iterable[Array]) -> bool:
    """Whether every entry of every array is finite, and none so large that its square is not."""
    for array in arrays:
        try:
            flat = array if array.ndim == 1 else array.reshape(-1)
            if not math.isfinite(flat.dot(flat)):
                return False
        except (AttributeError, TypeError, ValueError):  # not an array of numbers
            return False
    return True
