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
from pliant.rules import Rule

_POSTURE_SHARE = 0.05
"""factor on the default posture cost, for tasks without phases or posture"""
_TRACK = 1000.0  # 1/m²
_POSITION = Term(weight=_TRACK, terminal_times_dt=False)
_BY_CONTACT = {
    "free": PhaseCosts(translation=_POSITION),
    "contact": PhaseCosts(contact=True, translation=_POSITION.model_copy(update={"activation": (1.0, 1.0, 0.0)})),
}

_SEARCHED = (
    "the preset's: `tuned` where the task has delays, else `perfect`",
    "`pliant study polishing --tune CONTROLLER --trials 16`, [FFMPC] sec. VI as a start",
)
MPC_RULES = (
    Rule("frame", "the first frame of the task", "the task"),
    Rule("period", "the period of control, the controller's own at least", "the task's `simulation.period`"),
    Rule("gravity", "on where the robot does not compensate gravity by itself", "the task's `compensates`"),
    Rule("phase_by", "the phase's name where the task has phases, else contact as it is felt", "the task"),
    Rule(
        "phases.*",
        "the preset's for phases of the same name; else its last phase with contact, or its first without; where axes"
        " differ, a position of 1000 /m² on each that moves, and the force's cost on each that presses or yields",
        "[FFMPC] sec. VI-A has such phases; the task's `modes`",
    ),
    Rule(
        "contact.stiffness",
        "the believed one of the surface, half of Λ/dt² at most; where it is estimated online, the start of 3e4 N/m or"
        " the believed one if that is more",
        "the exponential step of the force is good up to Λ/dt²; a model that is too soft makes the force loop too fast",
    ),
    Rule(
        "contact.damping", "the believed one of the surface, where it is not estimated", "the task's `surface.damping`"
    ),
    Rule("contact.axes", "those of the believed surface, which turn along a path", "the task's `surface`"),
    Rule("contact.normal", "that of the believed surface at its top", "the task's `surface`"),
    Rule(
        "contact.dimension", "3 where a force is asked for beside the axis that presses, else 1", "the task's `modes`"
    ),
    Rule("contact.integrator", "exponential, which bears a stiff contact at the horizon's step", "docs/mpc_derivation"),
    Rule("compensation.*_delay", "as the task assumes it", "the task's `timing`"),
    Rule(
        "compensation.averaging", "the default, rounded to whole periods of control", "the task's `simulation.period`"
    ),
    Rule("contact.*", *_SEARCHED),
    Rule("costs.posture.*", "the preset's; 0.05 of it where phases mean nothing", _SEARCHED[1]),
    Rule("costs.*", *_SEARCHED),
)
"""of `suggest_mpc`, and of the presets that it starts from"""


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

    At most half of the largest stiffness of the exponential integrator, Λ/dt². Where they are estimated, a stiffness
    beyond the configured one is what the estimation starts from.
    """
    if not config.predictive_model.force_state or believed.stiffness is None or believed.damping is None:
        return config.contact
    first = config.contact.stiffness[0]
    if config.compensation.environment and believed.stiffness <= first:
        return config.contact
    placed = config.model_copy(update={"frame": believed.frames[0]})
    largest = 0.5 * float(np.min(task_inertia(placed, robot.model, robot.home))) / config.dt**2
    if config.compensation.environment:
        return config.contact.model_copy(update={"stiffness": (max(first, min(believed.stiffness, largest)),)})
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
