"""The guard checks every signal between the parts of the loop; invalid signals reach neither controller nor robot.

It checks each measurement, estimate, reference and command. A tick with valid signals passes unchanged. In a tick with
an invalid signal the remaining parts are not stepped, and the guard gives the command: the first such tick holds the
last torque that was sent, the following ones compensate gravity with joint damping, within the limits. Once this has
lasted `PATIENCE`, the run ends as failed. The kind of fault is in `Tick.guard`, in the log as `guard/fault`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

import numpy as np
import pinocchio as pin

from pliant import _guard
from pliant.errors import PliantError, RunFailedError, SignalError
from pliant.guard import sound
from pliant.guard.faults import Fault
from pliant.guard.first import check_first, check_plant, why_not
from pliant.interfaces import Plant
from pliant.robot import Robot
from pliant.signals import Command, Estimate, Measurement, Reference
from pliant.spatial import Array

PATIENCE = 0.05  # s of faults in a row after which the run ends
_DAMPING = 5.0  # N·m s/rad of each joint while the guard answers
_FROZEN = 3  # consecutive equal readings of a noisy sensor that count as a fault
_LATE = 1.5  # periods between two readings from which the second counts as late
_ROUNDING = 1e-9  # of a torque limit; a larger excess is cut off and reported


@dataclass(slots=True)
class Watched:
    """State of the guard. Consumed by its methods."""

    reading: Measurement
    """the last valid one; other parts may have written into it"""
    q: Array
    v: Array
    """(n,) copies of it, rad and rad/s, in case a part writes into its input"""
    torque: Array
    """(n,) the last torque sent, N·m; a copy, since a controller may use its array again"""
    n: int
    """number of joints"""
    frames: tuple[str, ...]
    """frames of the force sensors"""
    equal: dict[str, int] = field(default_factory=dict[str, int])
    """signal → number of consecutive readings equal to the one before"""
    estimated: float = -math.inf
    """time of the last sound estimate, s"""
    faults: int = 0
    """ticks in a row with a fault, up to now"""
    missed: int = 0
    """ticks since the last reading that was sound in itself"""
    refused: object = None
    """the last estimate, reference or command that was not sound"""
    seen: bool = False
    """whether a reading has passed"""
    last: dict[str, bytes] = field(default_factory=dict[str, bytes])
    """signal → the last reading of a noisy sensor, sound or not"""


class Guard:
    """Checks the signals of one loop.

    Args:
        plant: says its period, which of its sensors are noisy, and what it compensates by itself.
        robot: for limits and gravity. None: no limits are known, and the last torque is held instead of gravity's.

    Raises:
        ConfigError: a property of the plant breaks a rule.
    """

    def __init__(self, plant: Plant[object], robot: Robot | None = None) -> None:
        check_plant(plant)
        self._plant, self._robot = plant, robot
        self._period, self._noisy = plant.period, plant.noisy
        self._limit = None if robot is None else robot.torque_limit
        self._bound = None if self._limit is None else self._limit * (1.0 + _ROUNDING)
        self._data = None if robot is None else robot.model.createData()

    def init(self, measurement: Measurement) -> Watched:
        """Checks the first measurement, before anything is computed from it.

        Raises:
            ConfigError: it is no measurement.
            ShapeError: it does not fit the robot.
            SignalError: it is not finite.
        """
        check_first(measurement, None if self._robot is None else self._robot.n)
        frames = tuple(measurement.wrenches)
        if sound.reading_fault(measurement, len(measurement.q), frames):
            raise SignalError(f"a measurement was not finite at t = {measurement.time:.4f} s, the first one")
        sent = self._within(np.array(measurement.torque_sent))
        q, v = np.array(measurement.q), np.array(measurement.v)
        return Watched(measurement, q, v, sent, len(q), frames)

    # ------------------------------------------------------------------ signals

    def measurement(self, reading: Measurement, watched: Watched) -> Fault:
        """What is wrong with a measurement.

        Raises:
            SignalError: it is none.
        """
        if not isinstance(reading, Measurement):  # pyright: ignore[reportUnnecessaryIsInstance] (somebody's own part)
            raise SignalError(f"the plant gave {type(reading).__name__} in place of a measurement")
        watched.missed += 1
        fault = sound.reading_fault(reading, watched.n, watched.frames)
        if fault:
            return fault
        frozen = bool(self._noisy) and self._frozen(reading, watched)
        step, due = reading.time - watched.reading.time, watched.missed
        if watched.seen and step <= 0.0:
            return Fault.STALE if step == 0.0 else Fault.BACKWARD
        late = watched.seen and step > (due - 1 + _LATE) * self._period
        watched.seen, watched.reading, watched.missed = True, reading, 0  # sound in itself: time goes on from it
        watched.q, watched.v = reading.q.copy(), reading.v.copy()
        if late:
            return Fault.LATE
        return Fault.FROZEN if frozen else Fault.NONE

    def estimate(self, estimate: Estimate, watched: Watched) -> Fault:
        """What is wrong with an estimate."""
        if not sound.is_estimate(estimate, watched.n) or estimate.time <= watched.estimated:
            watched.refused = estimate
            return Fault.ESTIMATE
        watched.estimated = estimate.time
        return Fault.NONE

    def reference(self, reference: Reference, watched: Watched) -> Fault:
        """What is wrong with a reference."""
        if sound.is_reference(reference, watched.n):
            return Fault.NONE
        watched.refused = reference
        return Fault.REFERENCE

    def command(self, command: Command, watched: Watched) -> tuple[Command, Fault]:
        """A sound command within the limits, and what was wrong; with Fault.COMMAND it may not be used.

        Its diagnostics are for the log alone and are not looked at.
        """
        n = watched.n
        if isinstance(command, Command) and _guard.is_command(command, n, self._bound):  # pyright: ignore[reportUnnecessaryIsInstance] (somebody's own part)
            return command, Fault.NONE
        if not isinstance(command, Command) or not sound.is_torque(command.time, command.torque, n):  # pyright: ignore[reportUnnecessaryIsInstance] (somebody's own part)
            watched.refused = command
            return command, Fault.COMMAND
        within, clamped = self._within(command.torque), command.clamped
        if not sound.is_torque(command.time, clamped, n):
            clamped = np.zeros(n)
        if within is command.torque:
            return command if clamped is command.clamped else replace(command, clamped=clamped), Fault.NONE
        return replace(command, torque=within, clamped=clamped + command.torque - within), Fault.BEYOND_LIMIT

    @property
    def bound(self) -> Array | None:
        """(n,) N·m beyond which a torque is cut off; None: no limit is known."""
        return self._bound

    def passed(self, reading: Measurement, torque: Array, watched: Watched) -> None:
        """Takes over from ticks in which nothing was to be found, by reading and torque (n,) N·m of the last one."""
        watched.seen, watched.reading, watched.missed, watched.faults = True, reading, 0, 0
        watched.q, watched.v = reading.q.copy(), reading.v.copy()
        watched.estimated, watched.torque = reading.time, torque.copy()
        watched.equal.clear()
        watched.last.update({name: _signal(reading, name) for name in self._noisy})

    def fresh(self, reading: Measurement, watched: Watched) -> bool:
        """Whether every noisy sensor reads something new."""
        return all(_signal(reading, name) != watched.last.get(name) for name in self._noisy)

    def now(self, reading: Measurement, watched: Watched) -> float:
        """The time of a reading, sound or not; that of the last sound one if it has none. In s."""
        return reading.time if math.isfinite(reading.time) else watched.reading.time

    def shown(self, fault: Fault, reading: Measurement, watched: Watched) -> Measurement:
        """The measurement for observers: one of another size does not fit into a log, so the last valid one replaces
        it."""
        return replace(watched.reading, time=self.now(reading, watched)) if fault is Fault.SHAPE else reading

    def why_not(self, fault: Fault, watched: Watched) -> PliantError:
        """The error for a first tick that cannot be computed."""
        return why_not(fault, watched.refused, watched.n)

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
            watched.torque, watched.faults = np.array(command.torque, dtype=float), 0
            return command
        watched.faults += 1
        if watched.faults * self._period > PATIENCE + 0.5 * self._period:
            raise RunFailedError(f"{fault.words}; no sound signal came for {1e3 * PATIENCE:g} ms, so the run ended")
        if watched.faults > 1:
            watched.torque = self._gravity_and_damping(watched)
        return Command(self.now(reading, watched), watched.torque, np.zeros(watched.n), command.diagnostics)

    # ------------------------------------------------------------------ inside

    def _within(self, torque: Array) -> Array:
        """The torque itself if it is within the limits, else the clamped torque."""
        if self._limit is None or self._bound is None:
            return torque
        if not np.count_nonzero(np.abs(torque) > self._bound):
            return torque
        return np.clip(torque, -self._limit, self._limit)

    def _gravity_and_damping(self, watched: Watched) -> Array:
        """(n,) N·m at the last sound reading."""
        if self._robot is None or self._data is None:
            return watched.torque
        torque = -_DAMPING * watched.v
        if self._plant.compensates == "none":
            torque = torque + pin.computeGeneralizedGravity(self._robot.model, self._data, watched.q)
        return self._within(torque)

    def _frozen(self, reading: Measurement, watched: Watched) -> bool:
        """Whether a noisy sensor has given too many equal readings."""
        frozen = False
        last, equal = watched.last, watched.equal
        for name in self._noisy:
            now = _signal(reading, name)
            if now == last.get(name):
                equal[name] = equal.get(name, 0) + 1
                frozen = frozen or equal[name] >= _FROZEN - 1
            elif equal:
                equal[name] = 0
            last[name] = now
        return frozen


def _signal(reading: Measurement, name: str) -> bytes:
    if name != "wrenches":
        value: Array = getattr(reading, name)
        return value.tobytes()
    felt = [wrench.tobytes() for wrench in reading.wrenches.values()]
    return felt[0] if len(felt) == 1 else b"".join(felt)
