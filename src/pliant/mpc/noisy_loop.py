"""A loop that follows its own prediction with noise, for time measurements of solvers and nodes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from pliant.mpc.chain import chain_from_robot
from pliant.mpc.config import MpcConfig
from pliant.mpc.horizon import HorizonReference
from pliant.mpc.kernel import kernel_model, kernel_solver
from pliant.mpc.make_problem import problem_from_robot
from pliant.mpc.problem import MpcProblem
from pliant.robot import Robot
from pliant.spatial import Array

_PHASE = "circle"
_RADIUS, _SPEED, _FORCE = 0.07, 3.0, 50.0  # m, rad/s, N: the polishing circle
_PERIOD = 2e-3  # s between two solves


@dataclass(frozen=True)
class BenchCase:
    """What is measured."""

    name: str
    config: MpcConfig
    robot: Robot
    press: bool = False
    """press on one spot with a varying force, instead of following a circle, because a contact in 3 or 6 dimensions
    sticks"""


class NoisyLoop:
    """A robot that follows the solver's prediction, with sensor noise, round the polishing circle."""

    def __init__(self, case: BenchCase) -> None:
        self.problem: MpcProblem = problem_from_robot(case.robot, case.config)
        self.chain = chain_from_robot(case.robot, case.config.frame)
        self.model = kernel_model(self.problem)
        self.solver = kernel_solver(self.problem, self.chain, self.model)
        self.config, self.robot, self._press = case.config, case.robot, case.press
        self._rng = np.random.default_rng(0)
        self._home, self._R = case.robot.placement(case.robot.home, case.config.frame)
        self._count = case.config.horizon + 1
        self._time = 0.0
        self.problem.write_constants(self.solver.nodes)
        self.problem.write_phases(self.solver.nodes, (_PHASE,) * self._count)
        self.solver.nodes.anchor_translation[...] = self._home
        extra = self.solver.nx - 2 * case.robot.n
        gravity = pin.computeGeneralizedGravity(case.robot.model, case.robot.model.createData(), case.robot.home)
        pressing = self.problem.in_contact_axes(
            np.array([0.0, 0.0, _FORCE, 0.0, 0.0, 0.0]), self.problem.contact_axes(self._R, None)
        )
        model = case.config.predictive_model
        start = gravity if model.torque_state else pressing
        self.x = np.concatenate([case.robot.home, np.zeros(case.robot.n), start[:extra]])
        noise = 0.01 if model.force_state else 0.02  # N, N·m
        self._noise = np.concatenate([np.full(2 * case.robot.n, 1e-3), np.full(extra, noise)])
        self.solver.quasi_static(self.x)

    def next_state(self) -> Array:
        """(nx,) measured state one period later; the references are advanced too."""
        self._time += _PERIOD
        self.problem.write_references(self.solver.nodes, self._reference(), self.robot.home)
        return self.x + self._noise * self._rng.normal(size=self.x.shape)

    def follow(self, xs: Array) -> None:
        """The robot moves as planned."""
        share = _PERIOD / self.config.dt
        self.x = xs[0] + share * (xs[1] - xs[0])

    def _reference(self) -> HorizonReference:
        times = self._time + self.config.dt * np.arange(self._count)
        angle, zero = _SPEED * times, np.zeros(self._count)
        R = 0.0 if self._press else _RADIUS
        offset = R * np.stack([1.0 - np.cos(angle), -np.sin(angle), zero], axis=1)
        speed = R * _SPEED * np.stack([np.sin(angle), -np.cos(angle), zero, zero, zero, zero], axis=1)
        force = _FORCE + (10.0 * np.sin(angle) if self._press else zero)
        wrench = np.stack([zero, zero, force, zero, zero, zero], axis=1)
        turned = np.tile(self._R, (self._count, 1, 1))
        return HorizonReference(self._home + offset, turned, speed, wrench, None, (_PHASE,) * self._count)
