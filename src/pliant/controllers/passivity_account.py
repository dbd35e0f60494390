"""The passivity account of a sampled axis: the energy that its force absorbed beyond what is stored, and how much of it
may be spent.

Over a period the held force h takes in h·d, d the motion of the error, while the profile stores E(x̃ + d) − E(x̃).
The difference is added to the account at the next tick. Sampling, blending, clamps, bounds on torque steps and changes
of the tuning are paid from it. If the account is empty, the next force may not release more energy than the profile
does over the expected step. The idea is the passivity observer and controller of Hannaford and Ryu 2002.

This module is the reference implementation in Python; the stack runs `cpp/impedance/account.hpp`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from pliant.controllers.profiles import ForceProfile
from pliant.spatial import Array


@dataclass(frozen=True)
class AccountSettings:
    """Parameters of the account. The numbers were found by the search of `benchmarks/passivity_search.py`."""

    deposit: float = 0.5
    """share of an income beyond the debt that is kept"""
    ceiling: float = 0.01
    """J, largest balance: how much dissipated energy can be spent later"""
    savings: float = 0.3
    """J, most of what is beyond the ceiling that is put aside: it pays for what comes from outside, changes of the
    tuning and torque that was not sent, never for the axis' own force"""
    spend: float = 0.25
    """share of the balance, beyond the cost of a reversal, that may be spent in one period"""
    damping: float = 3.0
    """largest force that repays a debt, as a multiple of the step of a period times the largest recent slope of the
    profile over a step: a knee costs by its own slope, not by K_0"""
    tolerance: float = 0.005
    """J of debt that does not weaken an axis; at least ½ K_0 (T_s · speed)², what one sample at that speed leaks"""
    speed: float = 0.7
    """m/s"""
    speed_angular: float = 1.4
    """rad/s"""
    kick: float = 0.3
    """m/s, change of the speed that must be expected within one period: 300 m/s² at 1 kHz. The force is limited so that
    a motion back by this step stays within the balance"""
    kick_angular: float = 0.6
    """rad/s"""
    trickle: float = 0.004
    """W that an overdrawn axis may always release, so that its force does not vanish"""
    trust: float = 0.125
    """filter coefficient per period of the quality of the prediction; debts are repaid in proportion to it, because
    motions that reverse within a few periods would gain from a force that repays"""
    peak_time: float = 0.1
    """s for which the largest recent step and slope are used as bounds of the next ones"""
    surprise_time: float = 1.0
    """s for which the largest recent prediction error is used as bound of the next one"""
    forgiveness_time: float = 0.5
    """s over which debt beyond the tolerance is written off"""

    def numbers(self, period: float) -> Array:
        """(15,) as the compiled core takes them, for a period in s."""
        levels = (self.deposit, self.ceiling, self.savings, self.spend, self.damping, self.tolerance)
        speeds = (self.speed, self.speed_angular, self.kick, self.kick_angular)
        return np.array([*levels, *speeds, self.trickle, self.trust, *self.rates(period)])

    def rates(self, period: float) -> tuple[float, float, float]:
        """Shares per period of s: decay of the largest step and of the largest prediction error, write-off of a
        debt."""
        keep, memory = math.exp(-period / self.peak_time), math.exp(-period / self.surprise_time)
        return keep, memory, -math.expm1(-period / self.forgiveness_time)


STEPS = 6
"""number of past periods in which a repeated step is looked for"""
SMALL_STEP = 1e-6
"""m or rad; below it the difference of energies is rounding error"""
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
    steps: Array
    """(STEPS, k) by which the error moved in the last periods, newest first, m or rad; without targets that jump"""
    misses: Array
    """(STEPS, k) recent mean square error of each prediction of a step"""
    target: Array
    """by which the target moved the error in the last period, m or rad"""
    peak: Array
    """largest recent step, m or rad"""
    expected: Array
    """step that was expected for the period that follows, m or rad"""
    surprise: Array
    """largest recent difference of a step to what was expected, m or rad"""
    right: Array
    """recent mean of the expected step times the real one"""
    size: Array
    """recent mean of its absolute value"""
    slope: Array
    """largest recent slope of the profile over a step, N/m or N·m/rad"""


@dataclass(frozen=True)
class ErrorMotion:
    """What moved the error of `k` axes in the last period. All arrays (k,)."""

    robot: Array
    """error now, with the target of the last tick, m or rad"""
    work: Array
    """J that the force that was really sent took in from the robot"""


@dataclass(frozen=True)
class Account:
    """Books and bounds the force of `k` axes at a fixed period. Stateless: the state is passed in and returned."""

    period: float
    """s"""
    speed: Array
    """(k,) m/s or rad/s, for the tolerance"""
    kick: Array
    """(k,) m/s or rad/s, largest change of speed in one period"""
    settings: AccountSettings = ACCOUNT

    def init(self, profile: ForceProfile, error: Array) -> AccountState:
        """An empty account at an error (k,), m or rad."""
        zero = np.zeros_like(error)
        rows = np.zeros((STEPS, *error.shape))
        return AccountState(profile, zero, zero, profile.energy(error), rows, rows, *(zero,) * 7)

    def book(self, state: AccountState, last: Array, force: Array, error: Array, motion: ErrorMotion) -> AccountState:
        """Adds a period in which the error went from `last` to `error` (k,) and h = `force` (k,) was applied.

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
        return self._learn(replace(state, stored=stored, target=target), step)

    def restate(self, state: AccountState, profile: ForceProfile, error: Array) -> AccountState:
        """A change of the tuning: the increase of the stored energy is paid from savings and balance. The rest is
        supplied by whoever made the change, and leaves no debt. Args: error (k,) m or rad.
        """
        stored = profile.energy(error)
        income = np.maximum(state.stored - stored, -state.savings - np.maximum(state.balance, 0.0))
        paid = self._outside(state, income)
        return replace(paid, profile=profile, stored=stored, slope=np.zeros_like(stored))

    def allow(self, state: AccountState, error: Array, wanted: Array) -> tuple[Array, AccountState]:
        """The force (k,) nearest to the wanted one that the account allows, and the next state.

        Args:
            state: after the last period was added.
            error: (k,) m or rad.
            wanted: (k,) force of the law, N or N·m.
        """
        profile, settings, period = state.profile, self.settings, self.period
        keep, _, forgiven = settings.rates(period)
        d = likely_step(state)
        gain = profile.energy(error + d) - state.stored
        reversal = gain + profile.energy(error - d) - state.stored
        balance = state.balance - np.maximum(reversal, 0.0)
        over = np.where(np.abs(d) > SMALL_STEP, reversal, 0.0) / np.where(np.abs(d) > SMALL_STEP, d**2, 1.0)
        slope = np.maximum(np.maximum(over, profile.stiffness), state.slope * keep)
        known = state.size > 0.0
        right = np.where(known, np.maximum(state.right, 0.0) / np.where(known, state.size, 1.0), 1.0)
        repay = np.minimum(np.maximum(-balance, 0.0), right * settings.damping * slope * d**2)
        need = gain - settings.spend * np.maximum(balance, 0.0) + repay
        least = need / np.where(d == 0.0, 1.0, d)
        force = np.where((d != 0.0) & (wanted * d < need), least, wanted)
        force = np.where(d != 0.0, np.clip(force, -profile.force_max, profile.force_max), wanted)
        tolerance = np.maximum(settings.tolerance, 0.5 * profile.stiffness * (self.speed * period) ** 2)
        overdraft = np.maximum(-(state.stored + state.balance + tolerance), 0.0)
        peak = np.maximum(np.abs(state.steps[0]), state.peak * keep)
        state = replace(state, balance=state.balance + forgiven * overdraft, peak=peak, slope=slope, expected=d)
        return self._bounded_by_rest(state, tolerance, force), state

    def _learn(self, state: AccountState, step: Array) -> AccountState:
        """Updates the errors of the predictions with a step (k,)."""
        hit, trust = state.expected * step, self.settings.trust
        misses = state.misses + trust * ((step - guesses(state)) ** 2 - state.misses)
        right, size = state.right + trust * (hit - state.right), state.size + trust * (np.abs(hit) - state.size)
        surprise = np.maximum(np.abs(state.expected - step), state.surprise * self.settings.rates(self.period)[1])
        steps = np.concatenate([step[None], state.steps[:-1]])
        return replace(state, steps=steps, misses=misses, right=right, size=size, surprise=surprise)

    def _bounded_by_rest(self, state: AccountState, tolerance: Array, force: Array) -> Array:
        """Limits the force so that, for every next step within the recent prediction errors, the energy that leaves is
        covered by the balance (k,). After a debt the largest recent step in either direction counts.
        """
        left, least = state.stored + state.balance + tolerance, self.settings.trickle * self.period
        forward = np.where(force > 0.0, state.expected, -state.expected)
        against = np.maximum(self.kick * self.period, state.surprise) - forward
        bound = np.maximum(left, least) / np.where(against > 0.0, against, 1.0)
        bound = np.where(against > 0.0, bound, np.inf)
        force = np.clip(force, -bound, bound)
        bound = np.maximum(0.5 * left, least) / np.where(state.peak > 0.0, state.peak, 1.0)
        bound = np.where((state.balance < 0.0) & (state.peak > 0.0), bound, np.inf)
        return np.clip(force, -bound, bound)

    def _add(self, state: AccountState, income: Array) -> AccountState:
        """An income pays the debt first; a share of the rest is kept, and what exceeds the ceiling goes to the
        savings."""
        debt = np.minimum(np.maximum(-state.balance, 0.0), np.maximum(income, 0.0))
        kept = np.where(income > 0.0, debt + self.settings.deposit * (income - debt), income)
        beyond = np.maximum(state.balance + kept - self.settings.ceiling, 0.0)
        savings = np.minimum(state.savings + beyond, self.settings.savings)
        return replace(state, balance=state.balance + kept - beyond, savings=savings)

    def _outside(self, state: AccountState, income: Array) -> AccountState:
        """An income from outside; a cost is taken from the savings first."""
        paid = np.minimum(np.maximum(-income, 0.0), state.savings)
        return self._add(replace(state, savings=state.savings - paid), income + paid)


def guesses(state: AccountState) -> Array:
    """(STEPS, k) predictions of the next step: the last change continues, or the step of 2, 3 … periods ago is
    repeated."""
    last, before = state.steps[:2]
    size = np.maximum(np.abs(last), np.abs(before))
    return np.concatenate([np.clip(2.0 * last - before, -size, size)[None], state.steps[1:]])


def likely_step(state: AccountState) -> Array:
    """(k,) the expected step: a repetition is used only where it was by far the better prediction."""
    misses = np.concatenate([0.5 * state.misses[:1], state.misses[1:]])
    return np.take_along_axis(guesses(state), np.argmin(misses, axis=0)[None], axis=0)[0]
