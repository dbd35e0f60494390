"""What a predictive controller keeps between two steps."""

from __future__ import annotations

from dataclasses import dataclass, field

import pinocchio as pin

from pliant import _mpc
from pliant.spatial import Array
from tests.twins.mpc_step.compensation import CompensationState
from tests.twins.mpc_step.plan import Plan


@dataclass(slots=True)
class MpcState:
    """State of a predictive controller: the solver with its plan, and what the next step needs. Consumed by `step`."""

    solver: _mpc.Solver
    nodes: _mpc.Nodes
    """views into the solver"""
    data: pin.Data
    posture: Array
    """(n,) rad, where the controller started"""
    q: Array
    """(n,) last finite positions, rad"""
    v: Array
    """(n,) last finite velocities, rad/s"""
    next_solve: float
    """s"""
    compensation: CompensationState
    """torques under way and the shift of the force reference"""
    disturbance: Array
    """d̂ (n,), the last finite one, N·m; zero if it is not compensated"""
    plan: Plan | None = None
    phases: tuple[object, ...] = ()
    """what the weights in the nodes were written for"""
    touching: bool = False
    """whether the first node was in contact"""
    failures: int = 0
    """solves in a row that left no usable solution"""
    channels: dict[str, float | Array] = field(default_factory=dict[str, "float | Array"])
