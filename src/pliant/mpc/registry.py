"""The predictive controllers by name."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import pinocchio as pin

from pliant.entries import Believed, ControllerEntry
from pliant.errors import ConfigError
from pliant.interfaces import Controller, Needs
from pliant.mpc.axis_costs import with_felt_phases
from pliant.mpc.config import MpcConfig
from pliant.mpc.controller import MpcController
from pliant.mpc.costs import Term
from pliant.mpc.defaults import ClassicalMpc, ForceFeedbackMpc, OffsetFreeMpc, TorqueFeedbackMpc, ViscoElasticMpc
from pliant.mpc.modelled_force import ModelledForceMpc
from pliant.mpc.needs import MPC_RULES, needs_of, suggest_mpc
from pliant.robot import Robot


def build_mpc(robot: Robot, config: MpcConfig, period: float) -> MpcController:
    """A predictive controller from its configuration, for a control period in s.

    Raises:
        ConfigError: it would have to solve more often than the loop runs.
    """
    if config.period < period - 1e-9:
        raise ConfigError(
            f"period (time from solve to solve) must be at least the control period {period:g} s, got"
            f" {config.period:g} s"
        )
    return MpcController(robot if config.gravity else _weightless(robot), config, period)


def build_modelled_force(robot: Robot, config: MpcConfig, period: float) -> ModelledForceMpc:
    """The same with a modelled contact force instead of the measured one."""
    return ModelledForceMpc(robot if config.gravity else _weightless(robot), config, period)


def _weightless(robot: Robot) -> Robot:
    """The same robot without gravity: the model of a robot that compensates its weight by itself."""
    model = robot.model.copy()
    model.gravity = pin.Motion.Zero()
    return replace(robot, model=model)


def _entry(
    name: str,
    summary: str,
    default: MpcConfig,
    advise: Callable[[Robot, MpcConfig, Believed], tuple[str, ...]],
    build: Callable[[Robot, MpcConfig, float], Controller[Any]] = build_mpc,
    needs: Callable[[MpcConfig], Needs] = needs_of,
) -> ControllerEntry[MpcConfig]:
    return ControllerEntry(
        name,
        summary,
        default,
        build,
        advise,
        family="mpc",
        guarantees="finite torques within the limits; without a solution: gravity and damping",
        regulates_force=True,
        needs=needs,
        suggest=suggest_mpc,
        rules=MPC_RULES,
        filter=with_felt_phases,
    )


def advise_mpc(robot: Robot, config: MpcConfig, believed: Believed) -> tuple[str, ...]:
    """Warning about slow convergence: force costs along a surface on which the predicted contact slides."""
    if config.contact.friction is None:
        return ()
    phases = [phase.over(config.costs) for phase in config.phases.values() if phase.contact]
    terms = {"force": [costs.force for costs in phases], "force_rate": [costs.force_rate for costs in phases]}
    counted = [name for name, own in terms.items() if any(_counts_tangents(term) for term in own)]
    if not counted:
        return ()
    return (
        f"contact.friction with costs on the tangential force ({' and '.join(counted)}): many solves may end before"
        " they converge; set the activation of both terms to [0, 0, 1]",
    )


def _counts_tangents(term: Term) -> bool:
    given = term.activation[:2]
    return (term.weight > 0.0 or bool(term.terminal)) and any(value > 0.0 for value in given)


CONTROLLERS: Mapping[str, ControllerEntry[Any]] = {
    entry.name: entry
    for entry in (
        _entry(
            "force-feedback-mpc",
            "predictive, visco-elastic contact, the measured force is part of the state (Kleff et al. 2024)",
            ForceFeedbackMpc(),
            advise_mpc,
        ),
        _entry(
            "offset-free-mpc",
            "force feedback with disturbance observer, prediction over delays and force integral",
            OffsetFreeMpc(),
            advise_mpc,
        ),
        _entry(
            "visco-elastic-mpc",
            "predictive, visco-elastic contact, the force at the start of the prediction follows from"
            " position and velocity",
            ViscoElasticMpc(),
            advise_mpc,
            build_modelled_force,
            lambda config: replace(needs_of(config), wrench=False),
        ),
        _entry(
            "torque-feedback-mpc",
            "predictive, rigid contact, the measured joint torque is part of the state",
            TorqueFeedbackMpc(),
            advise_mpc,
        ),
        _entry(
            "classical-mpc",
            "predictive, rigid contact, feedback of position and velocity only",
            ClassicalMpc(),
            advise_mpc,
        ),
    )
}
"""name → entry"""
