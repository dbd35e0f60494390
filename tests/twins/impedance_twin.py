"""Python twin of one task of the compiled impedance core: pose errors in, wrench and ledger out."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from pliant.controllers.attractor import Attractor, AttractorState, Law, converging_force
from pliant.controllers.passivity_account import ErrorMotion
from pliant.controllers.phase_settings import PhaseSettings
from pliant.controllers.profiles import ForceProfile
from pliant.spatial import Array, log3
from tests.rotations import left_jacobian_inverse


@dataclass
class TwinTask:
    """Steps a 3- or 6-axis task with `Attractor`, and books its energies axis by axis."""

    law: Law
    period: float
    axes: int
    settings: PhaseSettings
    profile: ForceProfile | None = None
    state: AttractorState | None = None
    error: Array = field(default_factory=lambda: np.zeros(0))
    force: Array = field(default_factory=lambda: np.zeros(0))
    absorbed: Array = field(default_factory=lambda: np.zeros(0))
    injected: Array = field(default_factory=lambda: np.zeros(0))
    energy_start: Array = field(default_factory=lambda: np.zeros(0))
    supplied: float = 0.0
    target: tuple[Array, Array] = (np.zeros(3), np.eye(3))

    def step(
        self, pose: tuple[Array, Array], target: tuple[Array, Array], profile: ForceProfile, work: float
    ) -> dict[str, Array | float]:
        """One tick.

        Args:
            pose, target: position (3,), rotation (3, 3).
            profile: in force from now on.
            work: J that the joint torque of this task took in since the last tick.
        """
        attractor = self._attractor()
        error = self._error(target, pose)
        motion = None
        if self.state is None:
            self.state, self.profile = attractor.init(error), profile
            self.energy_start = profile.energy(error)
            self.absorbed = self.injected = np.zeros(self.axes)
        else:
            motion = self._motion(self._error(self.target, pose), work)
            self._book(attractor, error, target, profile)
        _, self.state = attractor.step(profile, error, self.state, motion)
        scale = self._moment_scale(error, profile)
        self.force = self.state.force * scale
        self.state = replace(self.state, force=self.force)
        self.error, self.target, self.profile = error, target, profile
        return self._report(attractor, scale)

    def _attractor(self) -> Attractor:
        rotates = np.arange(self.axes) >= 3
        floors = np.where(rotates, self.settings.rate_floor_angular, self.settings.rate_floor)
        return Attractor(self.period, floors, self.law, self.settings, rotates=rotates)

    def _error(self, target: tuple[Array, Array], pose: tuple[Array, Array]) -> Array:
        error = target[0] - pose[0]
        return error if self.axes == 3 else np.concatenate([error, log3(target[1] @ pose[1].T)])

    def _motion(self, robot: Array, work: float) -> ErrorMotion:
        """The work of each axis: h times its motion, and its share of what the torque did besides."""
        own = self.force * (robot - self.error)
        weight = np.abs(own)
        share = weight / weight.sum() if weight.any() else np.full(self.axes, 1.0 / self.axes)
        return ErrorMotion(robot, own + (work - own.sum()) * share)

    def _moment_scale(self, error: Array, profile: ForceProfile) -> Array:
        """(axes,) 1 for translations, one factor for the rotations."""
        scale = np.ones(self.axes)
        if self.axes == 6 and self.law is Law.CAPPED:
            assert self.state is not None
            moment = np.abs(left_jacobian_inverse(error[3:]) @ self.state.force[3:])
            bound = profile.force_max[3:]
            on = (bound > 0.0) & (moment > 0.0)
            scale[3:] = min(1.0, *(bound[on] / moment[on])) if on.any() else 1.0
        return scale

    def _report(self, attractor: Attractor, scale: Array) -> dict[str, Array | float]:
        assert self.state is not None
        assert self.profile is not None
        stored = self.profile.energy(self.error)
        margin = self.absorbed + self.injected - (stored - self.energy_start)
        wrench = np.concatenate([self.force[:3], np.zeros(3)])
        if self.axes == 6:
            wrench[3:] = left_jacobian_inverse(self.error[3:]) @ self.force[3:]
        account = self.state.account
        return {
            "wrench": wrench,
            "force": self.force,
            "error": self.error,
            "rate": self.state.rate,
            "rate_threshold": attractor.threshold(self.state),
            "phase": self.state.converging.astype(float),
            "turning_point": self.state.turning,
            "storage_margin": margin,
            "account": np.zeros(self.axes) if account is None else account.balance,
            "energy_stored": float(stored.sum()),
            "energy_supplied": self.supplied,
            "energy_dissipated": float(margin.sum()),
            "energy_tuning": float(self.injected.sum()),
            "moment_scale": float(scale[-1]),
        }

    def _book(self, attractor: Attractor, error: Array, target: tuple[Array, Array], profile: ForceProfile) -> None:
        assert self.state is not None
        assert self.profile is not None
        self.absorbed = self.absorbed + self.force * (error - self.error)
        self.supplied += float(self.force[:3] @ (target[0] - self.target[0]))
        if self.axes == 6:
            spatial = left_jacobian_inverse(self.error[3:]).T @ self.force[3:]
            self.supplied += float(spatial @ log3(target[1] @ self.target[1].T))
        if profile is not self.profile:
            before = storage(attractor.law, self.profile, self.state, error)
            self.injected = self.injected + storage(attractor.law, profile, self.state, error) - before


def works(torques: Array, kept_back: Array, way: Array) -> Array:
    """(tasks,) J that each task's torque took in: what was kept back of a joint is shared by size.

    Args:
        torques: (tasks, n) N·m that each task asked for.
        kept_back: (n,) N·m of their sum that was not sent.
        way: (n,) rad.
    """
    size = np.abs(torques)
    total = size.sum(axis=0)
    share = np.where(total > 0.0, size / np.where(total > 0.0, total, 1.0), 1.0 / len(torques))
    return -(torques - share * kept_back) @ way


def storage(law: Law, profile: ForceProfile, state: AttractorState, error: Array) -> Array:
    """E while diverging; E(x_m) minus what the convergence gave back since, by the midpoint rule in 32 steps."""
    inside = state.converging & (error * state.turning > 0.0) & (np.abs(error) < np.abs(state.turning))
    turning = np.where(inside, state.turning, 1.0)
    step = (turning - error) / 32
    work = sum(step * converging_force(law, profile, error + (i + 0.5) * step, turning) for i in range(32))
    return np.where(inside, profile.energy(turning) - work, profile.energy(error))
