"""Delay and averaging of a controller with compensation, in whole control periods.

Offset-free control by estimated disturbances: Pannocchia, Rawlings, "Disturbance models for offset-free
model-predictive control", AIChE Journal 49, 2003. Here the disturbance is a joint torque d̂ (momentum observer): the
problem is solved in ũ from the state at which its solution takes effect, and u = ũ − d̂ is sent. The compensations
themselves are part of the compiled step (`cpp/mpc/step`).
"""

from __future__ import annotations

from dataclasses import dataclass

from pliant.mpc.config import Compensation
from pliant.sampling import whole_periods


@dataclass(frozen=True)
class Delays:
    """Delays of a controller's commands."""

    under_way: int
    """periods between a reading and the effect of the command that answers to it"""
    averaged: int
    """number of torques in the mean that is sent, at least 1"""
    late: int
    """periods by which averaging delays a torque"""
    lead: float
    """s from an estimate to the effect of the command that answers to it"""


def delays_of(config: Compensation, period: float) -> Delays:
    """The delays of a configuration for a control period in s.

    Raises:
        ConfigError: a delay or an average that is not a whole number of periods.
    """
    under_way = whole_periods(
        config.delay, period, "compensation.sensing_delay + compensation.computation_delay", "the control period"
    )
    averaged = max(whole_periods(config.averaging, period, "compensation.averaging", "the control period"), 1)
    late = round(0.5 * (averaged - 1) + 1e-9)
    return Delays(under_way, averaged, late, config.computation_delay + late * period)
