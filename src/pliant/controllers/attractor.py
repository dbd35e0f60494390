"""The fractal attractor: when an axis diverges, when it converges, and its force.

This module is the reference
implementation in Python. The stack runs the same logic compiled (`cpp/impedance`); tests compare them tick by tick.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np
import numpy.typing as npt

from pliant.controllers.passivity_account import ACCOUNT, Account, AccountSettings, AccountState, ErrorMotion
from pliant.controllers.phase_settings import PhaseSettings
from pliant.controllers.profiles import ForceProfile
from pliant.spatial import Array

_PHASES = PhaseSettings()


class Law(StrEnum):
    """Which force an axis gives on the way back to its target."""

    CAPPED = "capped"
    """bounded by F_max; passive for any switching between divergence and convergence in continuous time; sampled, a
    passivity account bounds the energy that it can generate, to the millijoules given in docs/controllers.md"""
    HAPFIC = "hapfic"
    """[HapFIC] eq. 1 as printed; creates energy when the convergence is interrupted"""
    STACK_PRINTED = "stack-printed"
    """[Stack] Algorithm 1 as printed; its sign pushes away from the target, so it never settles"""
    STACK_CORRECTED = "stack-corrected"
    """[Stack] Algorithm 1 with the sign reversed; jumps where convergence starts, exceeds F_max beyond saturation"""
    SPRING = "spring"
    """no attractor: the profile alone, a spring without damping"""


Flags = npt.NDArray[np.bool_]


@dataclass(frozen=True)
class AttractorState:
    """State of `k` axes between two ticks. All arrays (k,)."""

    turning: Array
    """x_m, m or rad: error at which the convergence started; the current error while diverging"""
    converging: Flags
    """bool"""
    hold: Array
    """s for which the rate has been too small to determine the direction"""
    errors: tuple[Array, Array, Array]
    """the last three errors, newest first, m or rad"""
    rate: Array
    """low-passed d(error)/dt, m/s or rad/s"""
    noise: Array
    """variance of the noise of the error, m² or rad²"""
    force: Array
    """h of the last tick, N or N·m"""
    gap: Array
    """force that was missing when the convergence ended, N or N·m"""
    blend: Array
    """share of that force that is still missing, 1…0"""
    account: AccountState | None = None
    """of the capped law; None before the first step"""


@dataclass(frozen=True)
class Attractor:
    """Phase logic and force law of `k` axes at a fixed period. Stateless: the state is passed in and returned."""

    period: float
    """s"""
    floor: Array
    """(k,) smallest rate that determines a direction, m/s or rad/s"""
    law: Law = Law.CAPPED
    settings: PhaseSettings = _PHASES
    account: AccountSettings = ACCOUNT
    rotates: Flags | None = None
    """(k,) which axes are rotations; None: none"""

    def init(self, error: Array) -> AttractorState:
        """Starts diverging, with x_m = x̃. Args: error (k,) m or rad."""
        zero = np.zeros_like(error)
        noise = (self.floor / (3.0 * self.settings.noise_to_rate(self.period))) ** 2
        return AttractorState(
            error, np.zeros(error.shape, dtype=np.bool_), zero, (error, error, error), zero, noise, zero, zero, zero
        )

    def step(
        self, profile: ForceProfile, error: Array, state: AttractorState, motion: ErrorMotion | None = None
    ) -> tuple[Array, AttractorState]:
        """The force (k,) in N or N·m for the error of this tick (k,), and the next state.

        Args:
            profile: valid from now on; the account pays for a change from the last tick.
            error: x̃ (k,), m or rad.
            state: of the last tick.
            motion: what moved the error; None: the robot alone, against the force of the last tick.
        """
        motion = motion or ErrorMotion(error, state.force * (error - state.errors[0]))
        booked = self._booked(profile, error, state, motion) if self.law is Law.CAPPED else None
        wanted, state = self.wish(profile, error, state)
        if booked is None:
            return wanted, state
        force, account = self._account(error).allow(booked, error, wanted)
        return force, replace(state, force=force, account=account)

    def wish(self, profile: ForceProfile, error: Array, state: AttractorState) -> tuple[Array, AttractorState]:
        """The force of phases, law and blend, before the account limits it. Arguments and results as of `step`."""
        converged = state.converging
        state = self._switch(error, self._sense(error, state))
        law = self.law_force(profile, error, state)
        left = converged & ~state.converging
        gap = np.where(left, law - state.force, state.gap)
        blend = np.maximum(np.where(left, 1.0, state.blend) - self.settings.blend_step(self.period), 0.0)
        blended = np.clip(law - blend * gap, -profile.force_max, profile.force_max)
        force = np.where(blend > 0.0, blended, law)
        return force, replace(state, errors=(error, *state.errors[:2]), force=force, gap=gap, blend=blend)

    def threshold(self, state: AttractorState) -> Array:
        """ε (k,), m/s or rad/s: rates of |x̃| below it do not determine the direction."""
        return np.maximum(self.floor, 3.0 * self.settings.noise_to_rate(self.period) * np.sqrt(state.noise))

    def law_force(self, profile: ForceProfile, error: Array, state: AttractorState) -> Array:
        """The force of the law alone (k,), N or N·m, for a given phase."""
        turning = np.where(state.converging, state.turning, 1.0)  # 1.0: any number that is not zero
        back = converging_force(self.law, profile, error, turning)
        return np.where(state.converging, back, profile.force(error))

    def _account(self, error: Array) -> Account:
        rotates = np.zeros(error.shape, dtype=np.bool_) if self.rotates is None else self.rotates
        speed = np.where(rotates, self.account.speed_angular, self.account.speed)
        kick = np.where(rotates, self.account.kick_angular, self.account.kick)
        return Account(self.period, speed, kick, self.account)

    def _booked(self, profile: ForceProfile, error: Array, state: AttractorState, motion: ErrorMotion) -> AccountState:
        account, last = self._account(error), state.errors[0]
        booked = state.account or account.init(profile, last)
        booked = account.book(booked, last, state.force, error, motion)
        return booked if profile is booked.profile else account.restate(booked, profile, error)

    def _sense(self, error: Array, state: AttractorState) -> AttractorState:
        last, last_2, last_3 = state.errors
        # The third difference of a smooth motion is negligible; that of white noise has 20 times its variance. A step
        # of the reference or an impact is an outlier: clipped to three deviations, it hardly moves the estimate.
        third = error - 3.0 * last + 3.0 * last_2 - last_3
        floor = (self.floor / (3.0 * self.settings.noise_to_rate(self.period))) ** 2
        sample = np.minimum(third**2 / 20.0, 9.0 * state.noise + floor)
        noise = state.noise + self.settings.noise_gain(self.period) * (sample - state.noise)
        rate = state.rate + self.settings.rate_gain(self.period) * ((error - last) / self.period - state.rate)
        return replace(state, noise=noise, rate=rate)

    def _switch(self, error: Array, state: AttractorState) -> AttractorState:
        threshold = self.threshold(state)
        outward = np.where(error > 0.0, state.rate, -state.rate)
        beyond = (error * state.turning <= 0.0) | (np.abs(error) >= np.abs(state.turning))
        beyond = beyond | (self.law is Law.SPRING)
        out, back = beyond | (outward > threshold), ~beyond & (outward < -threshold)
        hold = np.where(out | back, 0.0, state.hold + self.period)
        converging = back | (~out & state.converging & (hold <= self.settings.hold_limit))
        return replace(state, converging=converging, hold=hold, turning=np.where(converging, state.turning, error))


def converging_force(law: Law, profile: ForceProfile, error: Array, turning: Array) -> Array:
    """Force on the way back, at an error between zero and the turning point.

    Args:
        law: which law; `spring` gives the profile's force.
        profile: of (k,) axes.
        error: x̃ (..., k), m or rad.
        turning: x_m (..., k), m or rad, not zero.

    Returns:
        h (..., k), N or N·m. [HapFIC] eq. 1 and [Stack] Algorithm 1 for the laws of that name. The capped law is
        h = sgn(x_m) sgn(s − ½) min(|F(x_m)| (2m − 1), |F(m x_m)|), with s = x̃/x_m and m = max(s, 1 − s).
    """
    share = error / turning
    peak = profile.magnitude(np.abs(turning))
    if law is Law.CAPPED:
        m = np.maximum(share, 1.0 - share)
        cap = np.minimum(peak * (2.0 * m - 1.0), profile.magnitude(m * np.abs(turning)))
        return np.where(share >= 0.5, 1.0, -1.0) * np.copysign(1.0, turning) * cap
    if law is Law.HAPFIC:
        return np.copysign(1.0, turning) * peak * (2.0 * share - 1.0)
    if law is Law.SPRING:
        return profile.force(error)
    towards = 4.0 * profile.energy(turning) / turning**2 * (error - 0.5 * turning)
    return towards if law is Law.STACK_CORRECTED else -towards
