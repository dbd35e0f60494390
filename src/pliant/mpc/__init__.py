"""Predictive control in contact: classical, torque feedback and force feedback, for any serial robot.

`MpcController` binds a configuration (`MpcConfig`, or one with defaults) to a robot and solves the problem with the
compiled core at every period.

The names below are imported on first use.
"""

from typing import TYPE_CHECKING, Any

from pliant.lazy import first_use

if TYPE_CHECKING:
    from pliant.mpc.config import Bounds, Compensation, Contact, MpcConfig
    from pliant.mpc.controller import MpcController, MpcState
    from pliant.mpc.costs import Costs, PhaseCosts, Term
    from pliant.mpc.defaults import ClassicalMpc, ForceFeedbackMpc, OffsetFreeMpc, TorqueFeedbackMpc
    from pliant.mpc.make_problem import problem_from_model, problem_from_robot
    from pliant.mpc.problem import MpcProblem
    from pliant.mpc.registry import CONTROLLERS

_WHERE = {
    "Bounds": "pliant.mpc.config",
    "Compensation": "pliant.mpc.config",
    "Contact": "pliant.mpc.config",
    "MpcConfig": "pliant.mpc.config",
    "MpcController": "pliant.mpc.controller",
    "MpcState": "pliant.mpc.controller",
    "Costs": "pliant.mpc.costs",
    "PhaseCosts": "pliant.mpc.costs",
    "Term": "pliant.mpc.costs",
    "ClassicalMpc": "pliant.mpc.defaults",
    "ForceFeedbackMpc": "pliant.mpc.defaults",
    "OffsetFreeMpc": "pliant.mpc.defaults",
    "TorqueFeedbackMpc": "pliant.mpc.defaults",
    "problem_from_model": "pliant.mpc.make_problem",
    "problem_from_robot": "pliant.mpc.make_problem",
    "MpcProblem": "pliant.mpc.problem",
    "CONTROLLERS": "pliant.mpc.registry",
}
"""name → module that has it"""

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


def __getattr__(name: str) -> Any:
    return first_use(__name__, _WHERE, name)
