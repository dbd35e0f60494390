"""The passivity account of a sampled axis: what its force took in beyond what is stored, and what it may spend of that.

Over a period the held force h takes in h·d, d the motion of the error, while the profile stores E(x̃ + d) − E(x̃).
The difference is booked at the next tick. Sampling, blending, clamps, bounds on torque steps and changes of the tuning
are paid from it. Where it holds nothing, the next force may not let out more than the profile gives back over the step
that is expected. The idea is the passivity observer and controller of Hannaford and Ryu 2002.

This module is the readable form; `cpp/impedance/account.hpp` is what the stack runs.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from pliant.controllers.profiles import ForceProfile
from pliant.spatial import Array


@dataclass(frozen=True)
class AccountSettings:
    """How the account books and spends. The numbers were found by the search of `benchmarks/passivity_search.py`."""

    deposit: float = 0.5
    """share that is kept of an income beyond the debt"""
    ceiling: float = 0.01
    """J, largest balance: what a past that dissipated can be drawn on later"""
    savings: float = 0.3
    """J, most of what is beyond the ceiling that is put aside: it pays for what comes from outside, changes of the
    tuning and torque that was not sent, never for the axis' own force"""
    spend: float = 0.25
    """share of the balance, beyond the cost of a reversal, that one period may spend"""
    damping: float = 1.5
    """largest force that repays a debt, as a multiple of K_0 times the step of a period"""
    tolerance: float = 0.005
    """J of debt that does not weaken an axis; at least ½ K_0 (T_s · speed)², what one sample may leak"""
    speed: float = 1.0
    """m/s"""
    speed_angular: float = 2.0
    """rad/s"""
    trickle: float = 0.02
    """W that an overdrawn axis may always let out, so that it never goes quite limp"""
    peak_time: float = 0.1
    """s for which the largest recent step counts as what may come next"""
    forgiveness_time: float = 0.5
    """s over which debt beyond the tolerance is written off"""

    def numbers(self, period: float) -> Array:
        """(11,) as the compiled core takes them, for a period in s."""
        rates = (math.exp(-period / self.peak_time), -math.expm1(-period / self.forgiveness_time))
        levels = (self.deposit, self.ceiling, self.savings, self.spend, self.damping, self.tolerance)
        return np.array([*levels, self.speed, self.speed_angular, self.trickle, *rates])


ACCOUNT = AccountSettings()
"""the default"""


@dataclass(frozen=True)
class AccountState:
    """State of `k` axes between two ticks. All arrays (k,)."""

    profile: ForceProfile
    """that was in force when `stored` was computed"""
    balance: Array
    """J taken in beyond what is stored"""
    savings: Array
    """J put aside"""
    stored: Array
    """J, E of the error"""
    step: Array
    """by which the error moved in the last period, m or rad; targets that jump are left out"""
    step_last: Array
    """in the one before"""
    target: Array
    """by which the target moved the error in the last period, m or rad"""
    peak: Array
    """largest recent step, m or rad"""


@dataclass(frozen=True)
class Motion:
    """What moved the error of `k` axes in the last period. All arrays (k,)."""

    robot: Array
    """error now, with the target of the last tick, m or rad"""
    work: Array
    """J that the force that was really sent took in from the robot"""


@dataclass(frozen=True)
class Account:
    """Books and bounds the force of `k` axes at a fixed period. Stateless: the state goes in and comes out."""

    period: float
    """s"""
    speed: Array
    """(k,) m/s or rad/s, for the tolerance"""
    settings: AccountSettings = ACCOUNT

    def init(self, profile: ForceProfile, error: Array) -> AccountState:
        """An empty account at an error (k,), m or rad."""
        zero = np.zeros_like(error)
        return AccountState(profile, zero, zero, profile.energy(error), zero, zero, zero, zero)

    def book(self, state: AccountState, last: Array, force: Array, error: Array, motion: Motion) -> AccountState:
        """Books a period in which the error went from `last` to `error` (k,) and h = `force` (k,) was asked for.

        A target that moves the error by r supplies h·r, or what the profile then stores more, whichever is larger.
        """
        stored, between = state.profile.energy(error), state.profile.energy(motion.robot)
        target = error - motion.robot
        supplied = np.maximum(force * target - (stored - between), 0.0)
        own = force * (motion.robot - last)
        state = self._outside(state, motion.work - own)
        state = self._add(state, own - (between - state.stored) + supplied)
        smooth = np.where(np.abs(target) < np.abs(state.target), target, state.target)
        step = motion.robot - last + np.where(target * state.target > 0.0, smooth, 0.0)
        return replace(state, stored=stored, step=step, step_last=state.step, target=target)

    def restate(self, state: AccountState, profile: ForceProfile, error: Array) -> AccountState:
        """A change of the tuning: what is stored more is taken from the balance. Args: error (k,) m or rad."""
        stored = profile.energy(error)
        return replace(self._outside(state, state.stored - stored), profile=profile, stored=stored)

    def allow(self, state: AccountState, error: Array, wanted: Array) -> tuple[Array, AccountState]:
        """The force (k,) nearest to the wanted one that the account allows, and the next state."""
        profile, settings = state.profile, self.settings
        size = np.maximum(np.abs(state.step), np.abs(state.step_last))
        d = np.clip(2.0 * state.step - state.step_last, -size, size)
        gain = profile.energy(error + d) - state.stored
        reversal = gain + profile.energy(error - d) - state.stored
        balance = state.balance - np.maximum(reversal, 0.0)
        repay = np.minimum(np.maximum(-balance, 0.0), settings.damping * profile.stiffness * d**2)
        need = gain - settings.spend * np.maximum(balance, 0.0) + repay
        least = need / np.where(d == 0.0, 1.0, d)
        force = np.where((d != 0.0) & (wanted * d < need), least, wanted)
        force = np.where(d != 0.0, np.clip(force, -profile.force_max, profile.force_max), wanted)
        tolerance = np.maximum(settings.tolerance, 0.5 * profile.stiffness * (self.speed * self.period) ** 2)
        forgiven = -math.expm1(-self.period / settings.forgiveness_time)
        overdraft = np.maximum(-state.stored - tolerance - state.balance, 0.0)
        state = replace(state, balance=state.balance + forgiven * overdraft)
        peak = np.maximum(np.abs(state.step), state.peak * math.exp(-self.period / settings.peak_time))
        left = np.maximum(0.5 * (state.stored + state.balance + tolerance), settings.trickle * self.period)
        bound = left / np.where(peak > 0.0, peak, 1.0)
        bound = np.where((state.balance < 0.0) & (peak > 0.0), bound, np.inf)
        return np.clip(force, -bound, bound), replace(state, peak=peak)

    def _add(self, state: AccountState, income: Array) -> AccountState:
        """An income pays the debt first; of the rest a share is kept, and what is beyond the ceiling put aside."""
        debt = np.minimum(np.maximum(-state.balance, 0.0), np.maximum(income, 0.0))
        kept = np.where(income > 0.0, debt + self.settings.deposit * (income - debt), income)
        beyond = np.maximum(state.balance + kept - self.settings.ceiling, 0.0)
        savings = np.minimum(state.savings + beyond, self.settings.savings)
        return replace(state, balance=state.balance + kept - beyond, savings=savings)

    def _outside(self, state: AccountState, income: Array) -> AccountState:
        """An income from outside; a cost is taken from the savings first."""
        paid = np.minimum(np.maximum(-income, 0.0), state.savings)
        return self._add(replace(state, savings=state.savings - paid), income + paid)
