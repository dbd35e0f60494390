"""Pushes from outside, as the seed of a run draws them."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from pliant.simulation import Push
from pliant.simulation.seeding import generator
from pliant.spatial import unit
from pliant.tasks.draws import drawn
from pliant.tasks.parts import Disturbance, Vector

_SHORTEST = 1e-3  # s, of a push: a normal distribution has no least value


def pushes_of(disturbances: Sequence[Disturbance], seed: int, seconds: float) -> tuple[Push, ...]:
    """The pushes of a run, one disturbance after the other. Args: seconds: that the run takes at most."""
    found: list[Push] = []
    rng = generator(seed, "pushes")
    for one in disturbances:
        time, end = one.start, seconds if one.end is None else min(one.end, seconds)
        while time < end:
            time += 0.0 if one.gap is None else drawn(one.gap, rng)
            force, duration = _push(one, rng), max(drawn(one.duration, rng), _SHORTEST)
            if time < end:
                found.append(Push(one.frame, force, time, duration))
            time = math.inf if one.gap is None else time + duration
    return tuple(found)


def _push(one: Disturbance, rng: np.random.Generator) -> Vector:
    if isinstance(one.push, tuple):
        return one.push
    if one.direction == "level":
        angle = float(rng.uniform(0.0, 2.0 * math.pi))
        way = np.array([math.cos(angle), math.sin(angle), 0.0])
    else:
        way = unit(rng.standard_normal(3), "a direction")
    x, y, z = (float(entry) for entry in drawn(one.push, rng) * way)
    return x, y, z
