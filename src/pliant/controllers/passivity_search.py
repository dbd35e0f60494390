"""A search for motions that draw energy from one sampled axis, whose target rests.

Histories are cycles that repeat for a while: out in two pieces, back in one, each at its own speed, before them a few
larger swings that dissipate energy and fill the account. Corners are rounded to a bounded acceleration. The best of a
round are varied in the next. The axis is the compiled one of the stack; the result is a lower bound of the worst case.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from pliant import _impedance
from pliant.controllers.attractor import Law
from pliant.controllers.passivity_account import ACCOUNT, AccountSettings
from pliant.controllers.phase_settings import PhaseSettings
from pliant.controllers.profiles import ForceProfile
from pliant.spatial import Array

SECONDS = 1.2
"""length of a history, s"""
_PHASES = PhaseSettings()
KEPT = 12
"""histories that a round keeps for the next one, for each quantity"""


@dataclass(frozen=True)
class Sampling:
    """Sampling of an axis, and bounds of its motion."""

    period: float
    """s"""
    acceleration: float = math.inf
    """largest of the motion, m/s² or rad/s²"""
    speed: float = 1.0
    """largest of the motion, m/s or rad/s"""
    rotates: bool = False
    account: AccountSettings | None = ACCOUNT
    """None: the law with its blend alone"""
    phases: PhaseSettings = _PHASES


@dataclass(frozen=True)
class Draw:
    """The most energy that was generated, J, and the number of trials."""

    cycle: float
    """per cycle, mean over those after the first"""
    settled: float
    """per cycle, mean over the second half of a history"""
    total: float
    """the largest over t0 < t1 of energy out minus what was stored at t0 and taken in since"""
    force: float
    """largest force as a share of F_max"""
    cycles: int


def forces(profile: ForceProfile, sampling: Sampling, errors: Array) -> tuple[Array, Array]:
    """Simulates one axis along given errors.

    Args:
        profile: of one axis.
        sampling: period, account, phases.
        errors: (steps, trials) m or rad.

    Returns:
        forces (steps, trials) in N or N·m, each held until the next step, and balances of the account, J.
    """
    errors = np.ascontiguousarray(errors)
    held, balances = np.empty_like(errors), np.empty_like(errors)
    numbers = (profile.stiffness, profile.force_max, profile.range, profile.linear_range)
    period, phases, rotates = sampling.period, sampling.phases, sampling.rotates
    _impedance.drive_axis(
        law=Law.CAPPED.value,
        period=period,
        rate_gain=phases.rate_gain(period),
        noise_gain=phases.noise_gain(period),
        hold_limit=phases.hold_limit,
        blend_step=phases.blend_step(period),
        account=None if sampling.account is None else sampling.account.numbers(period),
        shape=profile.shape.value,
        tuning=np.array([number[0] for number in numbers]),
        rate_floor=phases.rate_floor_angular if rotates else phases.rate_floor,
        rotates=rotates,
        errors=errors,
        forces=held,
        balances=balances,
    )
    return held, balances


def energy_out(errors: Array, held: Array) -> Array:
    """(steps, trials) J that left the axis since the start, with the force held over each step."""
    out = np.zeros_like(errors)
    out[1:] = -np.cumsum(held[:-1] * np.diff(errors, axis=0), axis=0)
    return out


def total_drawn(profile: ForceProfile, errors: Array, held: Array) -> Array:
    """(trials,) J: the largest over t0 < t1 of energy out minus what was stored at t0 and taken in since."""
    out = energy_out(errors, held)
    stored = profile.energy(errors[..., None])[..., 0]
    return (out - np.minimum.accumulate(out + stored, axis=0)).max(axis=0)


def search(profile: ForceProfile, sampling: Sampling, *, histories: int = 800, rounds: int = 4, seed: int = 0) -> Draw:
    """The most energy that cycles extract from an axis.

    Args:
        profile: of one axis.
        sampling: period, bounds of the motion, account.
        histories: of a round.
        rounds: the first is random, the others vary the best so far.
        seed: of the random numbers.
    """
    rng = np.random.default_rng(seed)
    shapes, pools = _random(rng, profile, sampling, histories), dict[str, tuple[Array, Array]]()
    most: dict[str, float] = {}
    force, cycles = 0.0, 0
    for _ in range(rounds):
        found, used, count = _evaluate(profile, sampling, shapes)
        force, cycles = max(force, used), cycles + count
        for name, values in found.items():
            most[name] = max(most.get(name, -math.inf), float(values.max()))
            before = pools.get(name, (np.empty((len(shapes), 0)), np.empty(0)))
            every, scores = np.hstack([before[0], shapes]), np.concatenate([before[1], values])
            best = np.argsort(scores)[::-1][:KEPT]
            pools[name] = every[:, best], scores[best]
        shapes = _varied(rng, sampling, pools, histories)
    return Draw(most["cycle"], most["settled"], most["total"], force, cycles)


# Rows of a history's shape: where the cycle begins, way of the first and of the second piece out, their speeds, speed
# back, size of the swings before, number of them.
def _random(rng: np.random.Generator, profile: ForceProfile, sampling: Sampling, n: int) -> Array:
    reach, speed = float(profile.range[0]), sampling.speed
    second = np.where(rng.random(n) < 0.5, 1e-9, rng.uniform(0.0, 0.3, n))
    ways = [rng.uniform(0.0, 1.2, n), rng.uniform(0.01, 0.8, n), second]
    speeds = [rng.uniform(0.1, 1.0, n), rng.uniform(0.02, 1.0, n), rng.uniform(0.02, 1.0, n)]
    before = reach * rng.uniform(0.05, 1.5, n)
    swings = rng.integers(0, 6, n) * (rng.random(n) < 0.5)
    rows = [*(reach * way for way in ways), *(speed * share for share in speeds), before, swings]
    return np.array(rows, dtype=np.float64)


def _varied(rng: np.random.Generator, sampling: Sampling, pools: Mapping[str, tuple[Array, Array]], n: int) -> Array:
    each = n // len(pools)
    best: Array = np.hstack([shapes[:, rng.integers(0, shapes.shape[1], each)] for shapes, _ in pools.values()])
    varied: Array = best * np.exp(0.2 * rng.standard_normal(best.shape))
    varied[3:6] = np.minimum(varied[3:6], sampling.speed)
    varied[7] = np.round(varied[7])
    return varied


def _evaluate(profile: ForceProfile, sampling: Sampling, shapes: Array) -> tuple[dict[str, Array], float, int]:
    """Per history: the energies extracted, the largest share of F_max, and the number of whole cycles."""
    errors, cycle, lead = _errors(shapes, sampling)
    held, _ = forces(profile, sampling, errors)
    out = energy_out(errors, held)
    count = np.floor((SECONDS - lead) / cycle + 1e-6).astype(int)
    trial, last = np.arange(errors.shape[1]), len(errors) - 1

    def drawn(first: Array) -> Array:
        """Mean over the cycles from the one numbered `first` (trials,); nothing where there are fewer than four."""
        start, end = (np.clip(np.round((lead + k * cycle) / sampling.period), 0, last) for k in (first, count))
        energy = out[end.astype(int), trial] - out[start.astype(int), trial]
        return np.where(count >= 4, energy / np.maximum(count - first, 1), -math.inf)

    total = total_drawn(profile, errors, held)
    found: dict[str, Array] = {"cycle": drawn(np.ones_like(count)), "settled": drawn(count // 2), "total": total}
    return found, float(np.abs(held).max() / profile.force_max[0]), int(count.sum())


def _errors(shapes: Array, sampling: Sampling) -> tuple[Array, Array, Array]:
    """(steps, trials) errors, (trials,) seconds of a cycle and of what comes before.

    A moving average over the time w turns a change of speed Δv into an acceleration Δv/w: it is taken of the exact
    integral. Cycles last whole periods, so that none is cut.
    """
    start, way_1, way_2, speed_1, speed_2, back, swing, swings = shapes
    period = sampling.period
    cycle = way_1 / speed_1 + way_2 / speed_2 + (way_1 + way_2) / back
    slower = np.ceil(cycle / period - 1e-9) * period / cycle
    speed_1, speed_2, back = speed_1 / slower, speed_2 / slower, back / slower
    fast = np.maximum(speed_1, back)
    swing = np.ceil(2.0 * swing / fast / period) * period * fast / 2.0
    once = 2.0 * swing / fast
    lead = swings * once
    times = way_1 / speed_1, way_2 / speed_2, (way_1 + way_2) / back
    cycle = times[0] + times[1] + times[2]
    corners = start, start + way_1, start + way_1 + way_2
    pieces = list(zip(times, corners, (speed_1, speed_2, -back), strict=True))
    swung = [(once / 2, start, fast), (once / 2, start + swing, -fast)]

    def integral(t: Array) -> Array:
        before = np.clip(t, 0.0, lead)
        return _repeated(before, once, swings, swung) + _repeated(t - before, cycle, np.inf, pieces)

    width = np.maximum(np.maximum(speed_1, speed_2), back) * 2.0 / sampling.acceleration
    width = np.maximum(width, 1e-7)
    t: Array = period * np.arange(int(SECONDS / period) + 1, dtype=np.float64)[:, None]
    return (integral(t + width) - integral(t)) / width, cycle, lead


def _repeated(t: Array, once: Array, most: Array | float, pieces: list[tuple[Array, Array, Array]]) -> Array:
    """∫ from 0 to t of a motion that repeats at most so often. pieces: (seconds, position at its start, speed)."""
    turns = np.minimum(np.floor(t / once), most)
    left, sum_left, sum_once = t - turns * once, 0.0, 0.0
    for seconds, position, speed in pieces:
        s = np.clip(left, 0.0, seconds)
        sum_left = sum_left + position * s + 0.5 * speed * s**2
        sum_once = sum_once + position * seconds + 0.5 * speed * seconds**2
        left = left - s
    return turns * sum_once + sum_left
