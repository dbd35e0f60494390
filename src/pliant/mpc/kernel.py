"""The compiled model, solver and step of a problem."""

from __future__ import annotations

import numpy as np

from pliant import _mpc
from pliant.mpc.compensation import Delays
from pliant.mpc.models import Kind
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


def kernel_step(problem: MpcProblem, chain: _mpc.Chain, delays: Delays, tick: float) -> _mpc.ControllerStep:
    """The compiled step of a controller that sends a command every `tick` s."""
    config, model, phases = problem.config, kernel_model(problem), problem.config.phases
    compensation, count = config.compensation, config.horizon + 1
    constants = _mpc.Nodes(count, chain, model)
    problem.write_constants(constants)
    rows = {name: _mpc.Nodes(count, chain, model) for name in phases}
    for name, nodes in rows.items():
        problem.write_phases(nodes, (name,) * count)
    return _mpc.ControllerStep(
        chain,
        model,
        constants,
        [(name, phases[name].contact, nodes) for name, nodes in rows.items()],
        frame=config.frame,
        contact_frame=problem.contact_frame,
        dt=config.dt,
        period=config.period,
        tick=tick,
        regularisation=config.regularisation,
        bounds=config.bounds.any,
        max_iterations=config.max_iterations,
        tolerance=config.tolerance,
        time_budget=config.time_budget,
        deadline=config.deadline,
        riccati=config.between == "riccati",
        interpolation=min(config.period / config.dt, 1.0),
        max_gap=config.max_gap,
        fallback_damping=config.fallback_damping,
        torque_limit=np.array(problem.torque_limit),
        R_world_surface=problem.R_world_surface,
        stiffness_max=problem.stiffness_max,
        reference_posture=config.posture == "reference",
        task_velocity=config.task_velocity,
        named_phases=config.phase_by == "name",
        torque_bounds=config.bounds.torque,
        disturbance=compensation.disturbance,
        environment=compensation.environment,
        force_integral=compensation.force_integral,
        force_shift_max=compensation.force_shift_max,
        under_way=delays.under_way,
        averaged=delays.averaged,
        late=delays.late,
        lead=delays.lead,
        environment_damping=compensation.environment_damping,
    )
