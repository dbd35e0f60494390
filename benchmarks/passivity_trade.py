"""What safety against motions that reverse between two ticks costs in settling: a line of JSON for each `kick`.

Run: OMP_NUM_THREADS=1 python benchmarks/passivity_trade.py [--kicks 0.3 0.5 0.7 1.0 1.4] [--histories 60] [--seed 77]

The more the speed is expected to change within a period (`kick`), the less an axis may brake: a braking force lets
energy out where the motion turns round. Searched: what cycles of unbounded acceleration draw, 1 kHz,
|v| ≤ 1 m/s.
Simulated: nine masses that start at rest 10 or 50 mm off their target, 1.5 to 10 kg, six of them undamped.
"""

from __future__ import annotations

import argparse
import json
from dataclasses import replace

import numpy as np
from passivity_search import ANGULAR, known

from pliant.controllers.attractor import Attractor
from pliant.controllers.passivity_account import ACCOUNT, AccountSettings
from pliant.controllers.passivity_search import Sampling, search
from pliant.controllers.profiles import ForceProfile
from pliant.spatial import Array

PERIOD, SUBSTEPS, SECONDS = 1e-3, 10, 3.0
MASS = np.array([1.5, 4.0, 10.0] * 3)
DAMPING = np.array([0.0] * 6 + [20.0, 40.0, 60.0])
TARGET = np.array([0.05] * 3 + [0.01] * 6)
BAND = 2e-4
"""m within which a mass counts as settled"""
SETTLED = ("STIFF_STACK ee translation", "SOFT_STACK ee translation", "leg x")
"""axes whose masses are simulated"""


def settling(profile: ForceProfile, account: AccountSettings) -> tuple[float, float]:
    """Mean time in s until the masses stay within the band, and the largest overshoot in m."""
    k, dt = len(MASS), PERIOD / SUBSTEPS
    names = ("stiffness", "force_max", "range", "linear_range")
    wide = replace(profile, **{name: np.full(k, getattr(profile, name)[0]) for name in names})
    attractor = Attractor(PERIOD, np.full(k, 0.5e-3), account=account)
    x, v, path = np.zeros(k), np.zeros(k), list[Array]()
    state = attractor.init(TARGET - x)
    for _ in range(round(SECONDS / PERIOD)):
        force, state = attractor.step(wide, TARGET - x, state)
        for _ in range(SUBSTEPS):
            v = v + (force - DAMPING * v) / MASS * dt
            x = x + v * dt
        path.append(x)
    off = np.array(path) - TARGET
    last = [int(np.max(np.nonzero(np.abs(row) > BAND)[0], initial=-1)) + 1 for row in off.T]
    return PERIOD * float(np.mean(last)), float(off.max())


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--kicks", type=float, nargs="+", default=[0.3, 0.5, 0.7, 1.0, 1.4], help="m/s")
    parser.add_argument("--histories", type=int, default=60, help="of a round; there are four")
    parser.add_argument("--seed", type=int, default=77)
    options = parser.parse_args()
    axes = list(known())
    for kick in options.kicks:
        account = replace(ACCOUNT, kick=kick, kick_angular=ANGULAR * kick)
        draws = []
        for _, profile, rotates in axes:
            scale = ANGULAR if rotates else 1.0
            sampling = Sampling(PERIOD, speed=scale, rotates=rotates, account=account)
            draws.append(search(profile, sampling, histories=options.histories, seed=options.seed))
        settled = {name: settling(profile, account) for name, profile, _ in axes if name in SETTLED}
        row = {
            "kick, m/s": kick,
            "mJ a cycle, median / worst": [
                round(1e3 * float(f([d.cycle for d in draws])), 1) for f in (np.median, np.max)
            ],
            "mJ in all, worst": round(1e3 * max(d.total for d in draws), 1),
            "settling, s / overshoot, mm": {name: [round(s, 3), round(1e3 * o, 1)] for name, (s, o) in settled.items()},
        }
        print(json.dumps(row), flush=True)


if __name__ == "__main__":
    main()
