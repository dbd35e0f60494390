"""References and estimates of one frame, and how an exploration is played over them."""

from __future__ import annotations

import numpy as np

from pliant.references.exploration.haptic_exploration import HapticExploration
from pliant.signals import Estimate, ImpedanceTuning, Reference, TaskReference

PERIOD = 1e-3


def tuned(axes: int = 3, range_: float = 0.02) -> ImpedanceTuning:
    stiffness = np.array([6000.0] * 3 + [60.0] * (axes - 3))
    force_max = np.array([100.0] * 3 + [10.0] * (axes - 3))
    return ImpedanceTuning(stiffness, force_max, np.array([range_] * 3 + [0.2] * (axes - 3)))


def task(
    frame: str = "foot", wrench=(0, 0, 40, 0, 0, 0), tuning: ImpedanceTuning | None = None, **more
) -> TaskReference:
    return TaskReference(
        frame, np.array([0.3, 0.1, 0.0]), wrench=np.array(wrench, float), tuning=tuning or tuned(), **more
    )


def reference(*tasks: TaskReference, tuning=None) -> Reference:
    return Reference(0.0, tasks, tuning=tuning)


def estimate(tick: int, **wrenches) -> Estimate:
    zero = np.zeros(3)
    return Estimate(tick * PERIOD, zero, zero, zero, zero, {k: np.array(v, float) for k, v in wrenches.items()})


def play(source: HapticExploration, ticks: int, first: int = 0, state=None, **wrenches):
    """The last reference and the state after a number of ticks with constant wrenches."""
    state = source.init(estimate(first, **wrenches)) if state is None else state
    out = None
    for tick in range(first, first + ticks):
        out, state = source.step(estimate(tick, **wrenches), state)
    return out, state
