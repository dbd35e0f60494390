"""The predictive controllers of [FFMPC] with the weights of its authors' polishing task, and the offset-free one."""

from __future__ import annotations

from typing import Any

from pydantic import Field

from pliant.mpc.config import Compensation, Contact, MpcConfig
from pliant.mpc.costs import Costs, PhaseCosts, Term
from pliant.mpc.models import Kind

_KIND = "which model predicts"
_PHASES = "costs of each phase by name"
_PLANE = (1.0, 1.0, 0.0)  # position is free along the normal, where the force is controlled


def _phases(track: Term, contact: Term, circle: Term) -> Any:
    phases = {
        "reach": PhaseCosts(translation=track),
        "track": PhaseCosts(translation=track),
        "contact": PhaseCosts(contact=True, translation=contact),
        "ramp": PhaseCosts(contact=True, translation=contact),
        "circle": PhaseCosts(contact=True, translation=circle),
        "approach": PhaseCosts(translation=track),
        "press": PhaseCosts(contact=True, translation=contact),
        "follow": PhaseCosts(contact=True, translation=circle),
        "leave": PhaseCosts(translation=track),
    }
    return Field(default=phases, min_length=1, description=_PHASES)


def _translation(weight: float, activation: tuple[float, ...], per_node: float | None = None) -> Term:
    return Term(weight=weight, activation=activation, per_node=per_node, terminal_times_dt=False)


_ALL = (1.0, 1.0, 1.0)
_POSTURE = Term(weight=0.02, activation=(20.0, 20.0, 20.0, 10.0, 10.0, 10.0))
_JOINT_VELOCITY = Term(weight=0.02, activation=(2.0,))
_VELOCITY = Term(weight=0.05, terminal=1.0)


def _costs(**own: Term) -> Costs:
    """The common cost terms of the controllers, and those of one controller."""
    shared = {
        "posture": _POSTURE,
        "joint_velocity": _JOINT_VELOCITY,
        "torque": Term(weight=1e-4),
        "rotation": Term(weight=20.0),
        "velocity": _VELOCITY,
    }
    return Costs(**{**shared, **own})


class ForceFeedbackMpc(MpcConfig):
    """Force feedback, [FFMPC] section V-C: the measured contact force is part of the state."""

    kind: Kind = Field(default="force_feedback", description=_KIND)
    costs: Costs = _costs(force=Term(weight=0.01, terminal=0.05), force_rate=Term(weight=6e-7))
    phases: dict[str, PhaseCosts] = _phases(
        _translation(10.0, _ALL, per_node=2.0), _translation(50.0, _PLANE), _translation(150.0, _PLANE)
    )


class OffsetFreeMpc(ForceFeedbackMpc):
    """Force feedback without offsets, for a robot with a delay of 1 ms of the readings and 5 ms of the commands.

    It starts from a stiff contact, with which it is stable on soft and stiff ones, and then uses the estimated
    stiffness.
    """

    contact: Contact = Contact(stiffness=(3e4,), damping=(1e2,), integrator="exponential")
    compensation: Compensation = Compensation(
        disturbance=True,
        sensing_delay=1e-3,
        computation_delay=5e-3,
        averaging=4e-3,
        force_integral=20.0,
        environment=True,
    )
    costs: Costs = _costs(
        posture=Term(weight=0.002, activation=_POSTURE.activation),
        torque=Term(weight=1e-5),
        force=Term(weight=0.03, terminal=0.15),
        force_rate=Term(weight=6e-7),
    )
    phases: dict[str, PhaseCosts] = _phases(
        _translation(10.0, _ALL, per_node=2.0), _translation(50.0, _PLANE), _translation(1000.0, _PLANE)
    )


class ViscoElasticMpc(ForceFeedbackMpc):
    """[FFMPC] section V-B: force feedback's model, with the force that its spring and damper give for q and v. The
    stiffness is that of the paper's table, because here it determines the force."""

    contact: Contact = Contact(stiffness=(1e4,), damping=(1e2,), integrator="exponential")


class ClassicalMpc(MpcConfig):
    """Classical, [FFMPC] section III-C: rigid contact, the measured force is not used."""

    kind: Kind = Field(default="classical", description=_KIND)
    contact: Contact = Contact(baumgarte=(0.0, 10.0))
    costs: Costs = _costs(force=Term(weight=1000.0))
    phases: dict[str, PhaseCosts] = _phases(
        _translation(5.0, _ALL, per_node=2.0), _translation(2.0, _ALL), _translation(60.0, _PLANE)
    )


class TorqueFeedbackMpc(MpcConfig):
    """Torque feedback, [FFMPC] section IV-C: rigid contact, the measured joint torque is part of the state."""

    kind: Kind = Field(default="torque_feedback", description=_KIND)
    contact: Contact = Contact(baumgarte=(0.0, 10.0))
    costs: Costs = _costs(
        posture=Term(weight=0.02, activation=(10.0, 10.0, 40.0, 10.0, 10.0, 50.0)),
        unfiltered_torque=Term(weight=1e-9),
        rotation=Term(weight=10.0),
        force=Term(weight=1000.0),
    )
    phases: dict[str, PhaseCosts] = _phases(
        _translation(12.0, _ALL, per_node=5.0), _translation(200.0, _PLANE), _translation(200.0, _PLANE)
    )
