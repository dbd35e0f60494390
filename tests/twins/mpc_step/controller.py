"""The whole step of a predictive controller in Python: what `cpp/mpc/step` compiles."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from pliant.errors import ConfigError, SignalError, options
from pliant.interfaces import Controller
from pliant.mpc import diagnostics
from pliant.mpc.chain import chain_from_robot
from pliant.mpc.compensation import delays_of
from pliant.mpc.config import MpcConfig
from pliant.mpc.controller import MpcController
from pliant.mpc.horizon import HorizonReference
from pliant.mpc.kernel import kernel_model, kernel_solver
from pliant.mpc.make_problem import problem_from_robot
from pliant.mpc.problem import MpcProblem, filled
from pliant.robot import Robot
from pliant.signals import Command, Estimate, Reference
from pliant.spatial import Array, all_finite, clamp
from tests.twins.mpc_step import channels
from tests.twins.mpc_step.compensation import Compensator
from tests.twins.mpc_step.horizon import along_horizon, require_pushing
from tests.twins.mpc_step.plan import SafeTorque, plan_of, torque_from, usable
from tests.twins.mpc_step.state import MpcState

_TICK = 1e-9  # s; smaller than any period, larger than the rounding of a clock


class TwinController(Controller[MpcState]):
    """What `MpcController` does, in Python: the same arguments, needs, channels and errors."""

    def __init__(self, robot: Robot, config: MpcConfig, period: float | None = None) -> None:
        self.robot, self.config, self.tick = robot, config, period or config.period
        self.problem: MpcProblem = problem_from_robot(robot, config)
        self.chain = chain_from_robot(robot, config.frame, config.contact.frame)
        self.delays = delays_of(config.compensation, period or config.period)
        self.model = kernel_model(self.problem)
        self.compensator = Compensator(config.compensation, self.problem, self.chain, period or config.period)
        self._safe = SafeTorque(robot.model, config.fallback_damping)
        self._limit = robot.torque_limit

    needs = MpcController.needs
    regulates_force = MpcController.regulates_force
    channels = MpcController.channels

    def init(self, estimate: Estimate) -> MpcState:
        """State before the first step.

        Raises:
            SignalError: the estimate lacks the contact force that force feedback needs, or is not finite.
            ShapeError: the estimate is of another robot.
        """
        q = np.array(self.robot.vector(estimate.q, "the estimate's q"))
        v = np.array(self.robot.vector(estimate.v, "the estimate's v"))
        self._measured_state(estimate, None)
        solver = kernel_solver(self.problem, self.chain, self.model)
        nodes = solver.nodes
        self.problem.write_constants(nodes)
        return MpcState(
            solver,
            nodes,
            self.robot.model.createData(),
            q,
            q,
            v,
            next_solve=estimate.time,
            compensation=self.compensator.init(estimate),
            disturbance=np.zeros(self.robot.n),
        )

    def step(self, estimate: Estimate, reference: Reference, state: MpcState) -> tuple[Command, MpcState]:
        task = next((task for task in reference.tasks if task.frame == self.config.frame), None)
        R_world_task = None if task is None else task.task_rotation
        x = self._measured_state(estimate, R_world_task)
        if all_finite(estimate.q, estimate.v):
            state.q, state.v = estimate.q, estimate.v
        if not all_finite(x):
            x = None
        disturbance = self.compensator.disturbance(estimate)
        if all_finite(disturbance):
            state.disturbance = disturbance
        turned_back = estimate.time < state.next_solve - self.config.period - _TICK
        if turned_back or estimate.time >= state.next_solve - _TICK:
            self._solve(estimate, reference, x, R_world_task, state)
            state.next_solve = estimate.time + self.config.period
        wanted, source = self._torque(estimate.time, x, state)
        within = clamp(wanted, -self._limit, self._limit)
        torque, state.compensation = self.compensator.send(within, state.compensation)
        found: Mapping[str, float | Array] = {
            **state.channels,
            "mpc/source": float(diagnostics.SOURCE_CODES[source]),
            "mpc/failures": float(state.failures),
            "mpc/disturbance": state.disturbance,
            "mpc/force_shift": state.compensation.force_shift,
        }
        return Command(estimate.time, torque, wanted - within, found), state

    # ------------------------------------------------------------------ inside

    def _solve(
        self, estimate: Estimate, reference: Reference, x: Array | None, R_world_task: Array | None, state: MpcState
    ) -> None:
        """Replaces the plan if there is a usable solution."""
        config = self.config
        if x is None:
            state.failures += 1
            state.channels = channels.of_no_solution(config.horizon, self.problem.m)
            return
        horizon = along_horizon(reference, config.frame, config.horizon, config.dt, self.compensator.lead)
        if config.contact.axes != "local":  # whose normal turns with the tool, and may be any of its axes
            require_pushing(horizon, self.problem.normals(horizon.task_rotation))
        state.compensation = self.compensator.integrate(estimate, reference, state.touching, state.compensation)
        horizon = self.compensator.shifted(horizon, state.compensation)
        self._write_environment(estimate, state)
        self.problem.write_axes(self.compensator.contact, R_world_task)
        x = self.compensator.ahead(x, state.disturbance, self._touches(estimate, state), state.compensation)
        self._write_horizon(horizon, estimate, x, state)
        if state.plan is None or state.failures:
            state.solver.reset()
            state.solver.quasi_static(x)
        elif estimate.time - state.plan.time > 0.5 * config.dt:
            state.solver.shift()
        solution = state.solver.solve(
            x, max_iterations=config.max_iterations, tolerance=config.tolerance, time_budget=config.time_budget
        )
        n = self.robot.n
        if usable(solution, config):
            state.plan, state.failures = plan_of(solution, estimate.time, n, config), 0
        else:
            state.failures += 1
        path = np.stack([self.chain.tool_placement(q)[1] for q in np.nan_to_num(solution.xs[:, :n])])
        in_contact = int(np.count_nonzero(state.nodes.contact_active))
        state.channels = channels.of_solution(solution, path, in_contact, config.deadline)

    def _write_horizon(self, horizon: HorizonReference, estimate: Estimate, x: Array, state: MpcState) -> None:
        named = self.config.phase_by == "name"
        phases = tuple((phase if named else "") or self._unnamed_phase(estimate) for phase in horizon.phase)
        key = (*phases, horizon.rotation is None)
        if key != state.phases:
            self.problem.write_phases(state.nodes, phases, oriented=horizon.rotation is not None)
            state.phases = key
        self.problem.write_references(state.nodes, horizon, state.posture)
        self.problem.write_torque_bounds(state.nodes, state.disturbance)
        self._write_anchor(state, horizon, x)

    def _write_environment(self, estimate: Estimate, state: MpcState) -> None:
        """Lets the estimated stiffness along the normal, as far as the integrator bears it, replace the assumed one,
        and the damping, where it is known well enough."""
        if not self.config.compensation.environment or self.problem.m == 0:
            return
        normal, contact = 0 if self.problem.m == 1 else 2, self.config.contact
        K, B = (float(filled(values, self.problem.m)[normal]) for values in (contact.stiffness, contact.damping))
        believed = estimate.environments.get(self.problem.contact_frame)
        if believed is not None:
            K = min(believed.stiffness, self.problem.stiffness_max)
            off = max(believed.damping_std, believed.stiffness * self.tick)
            if self.config.compensation.environment_damping and off <= 0.2 * believed.damping:
                B = believed.damping
        for nodes in (state.nodes, self.compensator.contact):
            nodes.stiffness[:, normal], nodes.damping[:, normal] = K, B

    def _touches(self, estimate: Estimate, state: MpcState) -> bool:
        """Whether there is contact now. A rigid one also needs a phase that has it."""
        touching = estimate.contacts.get(self.problem.contact_frame, state.touching)
        return touching and (state.touching or self.config.kind == "force_feedback")

    def _write_anchor(self, state: MpcState, horizon: HorizonReference, x: Array) -> None:
        """Where the contact rests: where it began, or where the reference will be when it begins."""
        touching = bool(state.nodes.contact_active[0])
        if touching and not state.touching:
            R, p = self.chain.contact_placement(x[: self.robot.n])
            state.nodes.anchor_translation[...] = p
            state.nodes.anchor_rotation[...] = R
        elif not touching:
            state.nodes.anchor_translation[...] = horizon.position
            if horizon.rotation is not None:
                state.nodes.anchor_rotation[...] = horizon.rotation
        state.touching = touching

    def _unnamed_phase(self, estimate: Estimate) -> str:
        """For a reference without phases: the first one that is (not) in contact, as the estimate says."""
        touches = bool(estimate.contacts.get(self.problem.contact_frame, False))
        for name, phase in self.config.phases.items():
            if phase.contact == touches:
                return name
        known = options(self.config.phases)
        raise ConfigError(f"a reference without phases needs a phase with contact = {touches}; {known}")

    def _measured_state(self, estimate: Estimate, R_world_task: Array | None) -> Array:
        """(nx,) x of now: q, v and, by kind, contact force (in axes of the task, where it has some) or joint torque."""
        if self.config.kind == "torque_feedback":
            return np.concatenate([estimate.q, estimate.v, estimate.torque])
        if self.config.kind != "force_feedback":
            return np.concatenate([estimate.q, estimate.v])
        frame = self.problem.contact_frame
        wrench = estimate.wrenches.get(frame)
        if wrench is None:
            known = options(estimate.wrenches)
            raise SignalError(f"force feedback needs the estimated contact wrench of frame {frame!r}; {known}")
        local = self.config.contact.axes == "local"
        R = self.chain.contact_placement(np.nan_to_num(estimate.q))[0] if local else None
        force = self.problem.in_contact_axes(wrench, self.problem.contact_axes(R, R_world_task))
        return np.concatenate([estimate.q, estimate.v, force])

    def _torque(self, time: float, x: Array | None, state: MpcState) -> tuple[Array, str]:
        if state.plan is not None:
            torque = torque_from(state.plan, time, x, self.config)
            if torque is not None and all_finite(torque):
                return torque - state.disturbance, "old plan" if state.failures else "plan"
        return self._safe.at(state.data, state.q, state.v), "gravity and damping"
