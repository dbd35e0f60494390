"""The parameters of the exploration for one axis, prepared for use in every tick."""

from __future__ import annotations

from dataclasses import astuple, dataclass
from enum import IntEnum
from typing import NamedTuple

from pliant.references.exploration.config import ExplorationConfig


class AxisPhase(IntEnum):
    """State of an axis."""

    OFF = 0
    """no force desired: the offset returns to zero"""
    FREE = 1
    """a force desired, no contact"""
    CONTACT = 2
    """regulating the force"""
    LOST = 3
    """contact lost while regulating: the offset is held"""


@dataclass(frozen=True, slots=True)
class AxisRules:
    """The configuration for one kind of axis; lengths in m or rad, forces in N or N·m."""

    gain: float
    speed: float
    reset: bool
    reset_speed: float
    seek_speed: float
    """0: no search"""
    stiffness_floor: float
    window: float
    least_motion: float
    contact_on: float
    contact_off: float
    contact_filter: float
    release_time: float
    lost_time: float
    unreachable_time: float
    turn_speed: float
    turn_time: float

    @staticmethod
    def of(config: ExplorationConfig, rotation: bool) -> AxisRules:
        """Picks the values for a linear or a rotation axis."""
        suffix = "_rotation" if rotation else ""

        def kind(name: str) -> float:
            return float(getattr(config, name + suffix))

        return AxisRules(
            gain=config.gain,
            speed=kind("speed"),
            reset=config.reset,
            reset_speed=kind("reset_speed"),
            seek_speed=kind("seek_speed") if config.seek else 0.0,
            stiffness_floor=kind("stiffness_floor"),
            window=config.window,
            least_motion=kind("least_motion"),
            contact_on=kind("contact_on"),
            contact_off=min(kind("contact_off"), kind("contact_on")),
            contact_filter=config.contact_filter,
            release_time=config.release_time,
            lost_time=config.lost_time,
            unreachable_time=config.unreachable_time,
            turn_speed=kind("turn_speed"),
            turn_time=config.turn_time,
        )

    @property
    def numbers(self) -> tuple[float, ...]:
        """All of them in order."""
        return tuple(map(float, astuple(self)))


class AxisLimits(NamedTuple):
    """Impedance of the axis in its controller."""

    stiffness: float
    """K_0, N/m"""
    force_max: float
    """F_max, N"""
    range: float
    """x_b, m: bound of the offset"""
