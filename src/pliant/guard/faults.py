"""Faults in a tick of the loop."""

from __future__ import annotations

from enum import IntEnum


class Fault(IntEnum):
    """Fault in a tick: the values of the channel `guard/fault`."""

    NONE = 0
    NOT_FINITE = 1
    """a measurement with NaN or an infinite number"""
    SHAPE = 2
    """a measurement of another size than before, or not of real numbers"""
    BACKWARD = 3
    """a measurement older than the last one"""
    STALE = 4
    """a measurement as old as the last one"""
    LATE = 5
    """a measurement half a period or more later than it should be; time goes on from it"""
    FROZEN = 6
    """a third equal reading in a row of a sensor that is noisy"""
    ESTIMATE = 7
    """an estimate that is not finite, of another size, no newer than the last one, or no estimate at all"""
    REFERENCE = 8
    """a reference that is not finite, of another size, or none at all"""
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
    Fault.SHAPE: "a measurement had another size than before, or was not of real numbers",
    Fault.BACKWARD: "a measurement was older than the last one",
    Fault.STALE: "no new measurement came",
    Fault.LATE: "measurements came late",
    Fault.FROZEN: "a noisy sensor gave the same reading again and again",
    Fault.ESTIMATE: "the estimate was not finite, of another size, or no newer than the last one",
    Fault.REFERENCE: "the reference was not finite or of another size",
    Fault.COMMAND: "the controller's torque was not finite or of another size",
    Fault.BEYOND_LIMIT: "the controller's torque was beyond the limits",
}
