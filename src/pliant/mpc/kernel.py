"""The compiled model and solver of a problem."""

from __future__ import annotations

from pliant import _mpc
from pliant.mpc.config import Kind
from pliant.mpc.problem import MpcProblem


def kernel_model(problem: MpcProblem, kind: Kind | None = None) -> _mpc.Model:
    """The compiled model of a problem, or one of another kind with the same contact."""
    contact = problem.config.contact
    return _mpc.Model(
        kind or problem.config.kind,
        problem.m,
        contact.axes,
        torque_bandwidth=problem.config.torque_bandwidth,
        baumgarte=contact.baumgarte,
        integrator=contact.integrator,
    )


def kernel_solver(problem: MpcProblem, chain: _mpc.Chain, model: _mpc.Model) -> _mpc.Solver:
    """A compiled solver of a problem; its nodes have neither weights nor references yet."""
    config = problem.config
    return _mpc.Solver(
        chain, model, config.horizon, config.dt, regularisation=config.regularisation, bounds=config.bounds.any
    )
