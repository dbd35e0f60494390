"""Python twin of one task of the compiled impedance core: pose errors in, wrench and ledger out."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from pliant.controllers.attractor import Attractor, AttractorState, Law, PhaseSettings, converging_force
from pliant.controllers.profiles import ForceProfile
from pliant.spatial import Array, left_jacobian_inverse, log3


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
        self, pose: tuple[Array, Array], target: tuple[Array, Array], profile: ForceProfile
    ) -> dict[str, Array | float]:
        """One tick. Args: pose, target (position (3,), rotation (3, 3)); profile in force from now on."""
        floors = np.array([self.settings.rate_floor] * 3 + [self.settings.rate_floor_angular] * 3)[: self.axes]
        attractor = Attractor(self.period, floors, self.law, self.settings)
        error = target[0] - pose[0]
        if self.axes == 6:
            error = np.concatenate([error, log3(target[1] @ pose[1].T)])
        if self.state is None:
            self.state, self.profile = attractor.init(error), profile
            self.energy_start = profile.energy(error)
            self.absorbed = self.injected = np.zeros(self.axes)
        else:
            self._book(attractor, error, target, profile)
        self.force, self.state = attractor.step(profile, error, self.state)
        self.error, self.target, self.profile = error, target, profile
        stored = profile.energy(error)
        margin = self.absorbed + self.injected - (stored - self.energy_start)
        wrench = np.concatenate([self.force[:3], np.zeros(3)])
        if self.axes == 6:
            wrench[3:] = left_jacobian_inverse(error[3:]) @ self.force[3:]
        return {
            "wrench": wrench,
            "force": self.force,
            "error": error,
            "rate": self.state.rate,
            "rate_threshold": attractor.threshold(self.state),
            "phase": self.state.converging.astype(float),
            "turning_point": self.state.turning,
            "storage_margin": margin,
            "energy_stored": float(stored.sum()),
            "energy_supplied": self.supplied,
            "energy_dissipated": float(margin.sum()),
            "energy_tuning": float(self.injected.sum()),
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


def storage(law: Law, profile: ForceProfile, state: AttractorState, error: Array) -> Array:
    """E while diverging; E(x_m) minus what the convergence gave back since, by the midpoint rule in 32 steps."""
    inside = state.converging & (error * state.turning > 0.0) & (np.abs(error) < np.abs(state.turning))
    turning = np.where(inside, state.turning, 1.0)
    step = (turning - error) / 32
    work = sum(step * converging_force(law, profile, error + (i + 0.5) * step, turning) for i in range(32))
    return np.where(inside, profile.energy(turning) - work, profile.energy(error))
