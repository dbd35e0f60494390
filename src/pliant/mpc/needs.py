"""Signals that a predictive controller needs, and parameters that suit a task."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from pliant.entries import Believed
from pliant.interfaces import Lookahead, Needs
from pliant.mpc.axis_costs import axis_costs
from pliant.mpc.config import Compensation, Contact, MpcConfig
from pliant.mpc.costs import PhaseCosts, Term
from pliant.mpc.make_problem import task_inertia
from pliant.robot import Robot

_POSTURE_SHARE = 0.05
"""factor on the default posture cost, for tasks without phases or posture"""
_TRACK = 1000.0  # 1/m²
_POSITION = Term(weight=_TRACK, terminal_times_dt=False)
_BY_CONTACT = {
    "free": PhaseCosts(translation=_POSITION),
    "contact": PhaseCosts(contact=True, translation=_POSITION.model_copy(update={"activation": (1.0, 1.0, 0.0)})),
}


def needs_of(config: MpcConfig) -> Needs:
    """The needs of a configuration; the preview begins now."""
    compensation = config.compensation
    explained = "normal" if config.contact.dimension == 1 else "all"
    return Needs(
        preview=Lookahead(config.horizon, config.dt),
        wrench=config.predictive_model.force_state,
        disturbance=explained if compensation.disturbance else "none",
        environment=compensation.environment,
        calm=compensation.any,
        torque=config.predictive_model.torque_state,
        posture=config.posture == "reference",
    )


def suggest_mpc(robot: Robot, config: MpcConfig, believed: Believed) -> MpcConfig:
    """The task's first frame, period and phases; the robot's delays, where the controller predicts over them.

    A phase without costs in the configuration has the costs of its last phase with contact, or of its first one
    without. Where the force is a state and the stiffness is not estimated, the believed stiffness is used. Where the
    task has no phases, the estimated contact state selects the costs of contact or free motion, and the position has
    more weight relative to the posture. Where phases have modes or bounds of single axes, each phase has its own costs.
    """
    named = bool(believed.phases)
    costs = config.costs
    posture = costs.posture.model_copy(update={"weight": _POSTURE_SHARE * costs.posture.weight})
    suited = config.model_copy(
        update={
            "costs": costs if named else costs.model_copy(update={"posture": posture}),
            "frame": believed.frames[0],
            "period": max(config.period, believed.period),
            "gravity": believed.compensation == "none",
            "phase_by": "name" if named else "contact",
            "phases": _phases(config, believed.phases) if named else _BY_CONTACT,
            "compensation": _timed(config.compensation, believed),
            "contact": _on_surface(_as_stiff(robot, config, believed), believed),
        }
    )
    if not believed.axes:
        return suited
    return suited.model_copy(update=axis_costs(suited, believed.axes, _POSITION, believed.turns))


def _as_stiff(robot: Robot, config: MpcConfig, believed: Believed) -> Contact:
    """With the believed stiffness and damping, where the force is a state and they are not estimated online.

    At most half of the largest stiffness of the exponential integrator, Λ/dt².
    """
    spring = config.predictive_model.force_state and not config.compensation.environment
    if not spring or believed.stiffness is None or believed.damping is None:
        return config.contact
    placed = config.model_copy(update={"frame": believed.frames[0]})
    largest = 0.5 * float(np.min(task_inertia(placed, robot.model, robot.home))) / config.dt**2
    update = {
        "stiffness": (min(believed.stiffness, largest),),
        "damping": (believed.damping,),
        "integrator": "exponential",
    }
    return config.contact.model_copy(update=update)


def _on_surface(contact: Contact, believed: Believed) -> Contact:
    """Force and position in the axes of the believed surface, which turn along a path."""
    if believed.surface is None:
        return contact
    normal = tuple(float(entry) for entry in believed.surface.normal(believed.surface.top()))
    return contact.model_copy(update={"axes": "surface", "normal": normal})


def _phases(config: MpcConfig, wanted: Mapping[str, bool]) -> dict[str, PhaseCosts]:
    free = next((phase for phase in config.phases.values() if not phase.contact), PhaseCosts())
    touching = next((phase for phase in reversed(config.phases.values()) if phase.contact), PhaseCosts(contact=True))
    unknown = {name: touching if touches else free for name, touches in wanted.items() if name not in config.phases}
    return config.phases | unknown


def _timed(compensation: Compensation, believed: Believed) -> Compensation:
    """The delays that are believed, and an average over whole periods."""
    update: dict[str, float] = {}
    if compensation.delay:
        update |= {"sensing_delay": believed.sensing_delay, "computation_delay": believed.computation_delay}
    count = compensation.averaging / believed.period
    if abs(count - round(count)) > 1e-6:
        update["averaging"] = max(round(count), 1) * believed.period
    return compensation.model_copy(update=update)
