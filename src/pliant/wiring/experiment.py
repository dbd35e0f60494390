"""A wired loop."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from pliant import loop
from pliant.entries import ControllerConfig
from pliant.interfaces import Controller, Estimator, Observer, Plant, ReferenceSource
from pliant.robot import Robot
from pliant.simulation.limited_plant import LimitedPlant, RunLimits
from pliant.telemetry.channels import Channel


@dataclass(frozen=True)
class Experiment:
    """A wired loop, ready to run."""

    robot: Robot
    plant: Plant[Any]
    estimator: Estimator[Any]
    source: ReferenceSource[Any]
    controller: Controller[Any]
    channels: tuple[Channel, ...] = ()
    """units of what the controller and the source report"""
    duration: float | None = None
    """s after which the task is done; None: it does not end"""
    warnings: tuple[str, ...] = ()
    """warnings about the parameters, as sentences"""
    parameters: ControllerConfig | None = None
    """of the controller, as it was built; None: not known"""
    model: Robot | None = None
    """the robot as the controller believes it; None: not known"""
    limits: RunLimits | None = None
    """limits at which a run ends as failed; None: no limits"""

    def run(self, clock: Iterable[object], observers: Sequence[Observer] = ()) -> loop.Outcome:
        """Runs the loop, within the limits if there are any. Args and errors as of `loop.run`."""
        plant = self.plant if self.limits is None else LimitedPlant(self.plant, self.limits, self.robot.torque_limit)
        return loop.run(plant, self.estimator, self.source, self.controller, clock, observers, self.robot)
