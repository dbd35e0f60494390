"""A wired loop."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from pliant.entries import ControllerConfig
from pliant.interfaces import Controller, Estimator, Plant, ReferenceSource
from pliant.robot import Robot
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
    """s after which there is nothing more to do; None: it goes on"""
    warnings: tuple[str, ...] = ()
    """what is unsafe about the parameters, in sentences"""
    parameters: ControllerConfig | None = None
    """of the controller, as it was built; None: not known"""
