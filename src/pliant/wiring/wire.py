"""A controller and what a task offers → a wired loop."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from pliant.controllers.joint_limits import JointLimitsConfig, with_joint_limits
from pliant.controllers.step_limit import DEFAULT_SHARE, StepLimit
from pliant.entries import Believed, ControllerConfig, ControllerEntry
from pliant.errors import ConfigError
from pliant.interfaces import Controller, Lookahead, Plant, ReferenceSource
from pliant.robot import Robot
from pliant.simulation.limited_plant import RunLimits
from pliant.telemetry.channels import Channel
from pliant.wiring.estimators import SensorFilters, estimator_for
from pliant.wiring.experiment import Experiment


@dataclass(frozen=True)
class Offer:
    """What a task provides for the loop, whatever the controller."""

    robot: Robot
    """whose limits bound the controller"""
    believed: Believed
    plant: Callable[[bool], Plant[Any]]
    """whether a force signal is needed → the robot in its world"""
    source: Callable[[Lookahead | None], ReferenceSource[Any]]
    """preview that is wanted → references"""
    model: Robot | None = None
    """as the controller and the estimators believe it; None: `robot`"""
    sensing: SensorFilters = field(default_factory=SensorFilters)
    torque_step: float | None = DEFAULT_SHARE
    """share of each joint's limit by which its torque may change per period; None: unbounded"""
    joint_limits: JointLimitsConfig | None = None
    """springs that keep the joints off their limits; None: without"""
    channels: tuple[Channel, ...] = ()
    """units of what the source reports"""
    no_force_signal: str = ""
    """remedy if a force is asked for without a force signal; empty: there is a force signal"""
    duration: float | None = None
    """s that the task takes; None: it goes on"""
    warnings: tuple[str, ...] = ()
    limits: RunLimits | None = None
    """where a run ends as failed; None: nowhere"""


def parameters_for(
    entry: ControllerEntry[Any],
    robot: Robot,
    believed: Believed,
    changes: Mapping[str, Any],
    base: ControllerConfig | None = None,
) -> ControllerConfig:
    """A controller's parameters: what suits the task, starting from `base` (None: its default), then `changes`.

    Raises:
        ConfigError: an unknown key or a bad value.
    """
    suited: ControllerConfig = entry.suggest(robot, entry.default if base is None else entry.over(base), believed)
    return entry.changed(suited, changes)


def wired(entry: ControllerEntry[Any], parameters: ControllerConfig, offer: Offer) -> Experiment:
    """The loop of a task with a controller: estimators and preview from its needs, with bounds and units.

    Raises:
        PliantError: a robot, frame or parameter that does not fit.
    """
    robot, believed = offer.robot, offer.believed
    model = robot if offer.model is None else offer.model
    core: Controller[Any] = entry.build(model, parameters, believed.period)
    needs, filtered = core.needs, entry.needs(parameters)
    felt = offer.sensing.felt or needs.wrench or filtered.wrench
    if offer.no_force_signal and (needs.wrench or filtered.wrench):
        raise ConfigError(
            f"controller {entry.name!r} needs the contact wrench at frame {believed.presses or believed.frames[0]!r},"
            f" and there is no force signal: {offer.no_force_signal}, or use a controller that needs none"
            " (`pliant list controllers`)"
        )
    controller = with_joint_limits(core, robot, offer.joint_limits)
    if offer.torque_step is not None:
        controller = StepLimit(controller, robot, offer.torque_step)
    sensing = replace(offer.sensing, felt=felt)
    return Experiment(
        robot=robot,
        plant=offer.plant(felt),
        estimator=estimator_for(needs, model, believed, sensing),
        source=entry.filter(offer.source(needs.preview), robot, parameters),
        controller=controller,
        channels=(*_channels(controller, entry, parameters, believed), *offer.channels),
        duration=offer.duration,
        warnings=(
            *_unregulated(entry, core, believed),
            *entry.advise(robot, parameters, believed),
            *offer.warnings,
        ),
        parameters=parameters,
        model=model,
        limits=offer.limits,
    )


def _channels(
    controller: Controller[Any], entry: ControllerEntry[Any], parameters: ControllerConfig, believed: Believed
) -> list[Channel]:
    found = [Channel(name, about.unit) for name, about in controller.channels.items()]
    frames = believed.frames if believed.presses is None else (believed.presses,)
    return found + [Channel(name, unit) for name, unit in entry.filter_channels(parameters, frames).items()]


def _unregulated(entry: ControllerEntry[Any], core: Controller[Any], believed: Believed) -> list[str]:
    if believed.presses is None or entry.regulates_force or core.regulates_force:
        return []
    return [
        f"controller {entry.name!r} does not regulate a force: the force that this task asks for at frame"
        f" {believed.presses!r} will not be held; `pliant list controllers` says who does"
    ]
