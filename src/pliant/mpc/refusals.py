"""Errors of a step of the compiled core."""

from __future__ import annotations

import numpy as np

from pliant import _mpc
from pliant.errors import ConfigError, PliantError, SignalError, options
from pliant.mpc.problem import MpcProblem
from pliant.signals import Estimate, Reference


def refused(refusal: _mpc.Refusal, problem: MpcProblem, estimate: Estimate, reference: Reference) -> PliantError:
    """The error of a step that the compiled core refused."""
    fault, node, value, normal = refusal
    frame, phases = problem.config.frame, problem.config.phases
    if fault == "no_wrench":
        return no_wrench(problem.contact_frame, estimate)
    if fault == "no_disturbance":
        return SignalError(
            "compensation.disturbance needs an estimated disturbance: put a MomentumObserver round the estimator"
        )
    if fault == "no_task":
        got = [task.frame for task in reference.tasks]
        return SignalError(f"the reference must have a task for frame {frame!r}, it has {got}")
    if fault == "reference_not_finite":
        return SignalError(f"the reference of frame {frame!r} must be finite")
    if fault == "pulls":
        return _pulls(value, normal)
    if fault == "no_phase_for_contact":
        known = options(phases)
        return ConfigError(f"a reference without phases needs a phase with contact = {value > 0.0}; {known}")
    names = reference.preview.phase if reference.preview is not None else (reference.phase,)
    unknown = next((name for name in names if name and name not in phases), str(node))
    return ConfigError(f"no costs for phase {unknown!r}; {options(phases, unknown)}")


def no_wrench(frame: str, estimate: Estimate) -> SignalError:
    """The error of an estimate without the wrench of a contact frame."""
    known = options(estimate.wrenches)
    return SignalError(f"force feedback needs the estimated contact wrench of frame {frame!r}; {known}")


def _pulls(force: float, normal: tuple[float, float, float]) -> ConfigError:
    return ConfigError(
        f"a desired force of {force:.3g} N along the surface's outward normal {np.round(normal, 3).tolist()}"
        " pulls, and a contact can only push: ask for a reaction along the normal, or, where the surface faces the"
        " other way, say so with contact.axes = 'surface' and contact.normal"
    )
