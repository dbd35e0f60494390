"""Predictive control in contact: classical, torque feedback and force feedback, for any serial robot.

`MpcController` binds a configuration (`MpcConfig`, or one with defaults) to a robot and solves the problem with the
compiled core at every period.
"""

from pliant.mpc.config import Bounds, Compensation, Contact, MpcConfig
from pliant.mpc.controller import MpcController, MpcState
from pliant.mpc.costs import Costs, PhaseCosts, Term
from pliant.mpc.defaults import ClassicalMpc, ForceFeedbackMpc, OffsetFreeMpc, TorqueFeedbackMpc
from pliant.mpc.make_problem import problem_from_model, problem_from_robot
from pliant.mpc.problem import MpcProblem
from pliant.mpc.registry import CONTROLLERS

__all__ = [
    "CONTROLLERS",
    "Bounds",
    "ClassicalMpc",
    "Compensation",
    "Contact",
    "Costs",
    "ForceFeedbackMpc",
    "MpcConfig",
    "MpcController",
    "MpcProblem",
    "MpcState",
    "OffsetFreeMpc",
    "PhaseCosts",
    "Term",
    "TorqueFeedbackMpc",
    "problem_from_model",
    "problem_from_robot",
]
