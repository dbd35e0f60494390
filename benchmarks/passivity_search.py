"""Energy that searched motions draw from one axis: presets, then random tunings. JSON, mJ; the last line sums up.

Run: OMP_NUM_THREADS=1 python benchmarks/passivity_search.py [--histories 800] [--sets 100] [--seed 1] [--control]

Settings are chosen on some seeds; what is claimed is searched on others.
"""

from __future__ import annotations

import argparse
import json
import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from pliant.controllers import presets
from pliant.controllers.passivity_account import ACCOUNT
from pliant.controllers.passivity_search import Draw, Sampling, search
from pliant.controllers.profiles import ForceProfile, Shape
from pliant.signals import ImpedanceTuning
from pliant.studies.haptic.steps_config import FootImpedance

BOUNDS = ((1e-3, math.inf), (1e-3, 300.0), (3e-3, 100.0))
"""(period in s, largest acceleration in m/s²)"""
QUANTITIES = ("cycle", "settled", "total")
ANGULAR = 2.0
"""rad per m: rotations are moved with so much more speed and acceleration"""


def one(tuning: ImpedanceTuning, axis: int, shape: Shape) -> ForceProfile:
    bend = None if tuning.linear_range is None else tuning.linear_range[axis : axis + 1]
    parts = (part[axis : axis + 1] for part in (tuning.stiffness, tuning.force_max, tuning.range))
    return ForceProfile.of(ImpedanceTuning(*parts, bend), shape)


def known() -> Iterator[tuple[str, ForceProfile, bool]]:
    for name in ("STIFF_STACK", "SOFT_STACK", "TABLE_I_SIMULATION", "TABLE_I_ROBOT"):
        for task in getattr(presets, name).frame_tasks():
            for axis in range(0, task.axes, 3):
                yield (
                    f"{name} {task.label} {'rotation' if axis else 'translation'}",
                    one(task.tuning, axis, task.shape),
                    axis > 0,
                )
    leg = FootImpedance()
    for axis in (0, 2):
        yield f"leg {'xyz'[axis]}", one(leg.tuning(), axis, leg.profile), False


def random_profile(rng: np.random.Generator) -> ForceProfile:
    """200 N/m to 20 kN/m, 10 to 300 N, the knee at 30 to 95 % of the range, either shape."""
    stiffness, force_max = 10.0 ** rng.uniform(2.3, 4.3), 10.0 ** rng.uniform(1.0, 2.5)
    bend = min(force_max / stiffness * rng.uniform(0.4, 0.99), 0.1)
    reach, shape = bend / rng.uniform(0.3, 0.95), Shape(rng.choice(list(Shape)))
    return ForceProfile.of(ImpedanceTuning(*(np.array([x]) for x in (stiffness, force_max, reach, bend))), shape)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--histories", type=int, default=800, help="of a round; there are four")
    parser.add_argument("--sets", type=int, default=100, help="random tunings")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--control", action="store_true", help="without the account: what must draw energy")
    parser.add_argument("--kick", type=float, help="m/s by which a period may change the speed without notice")
    options = parser.parse_args()
    rng, cycles = np.random.default_rng(options.seed), 0
    account = None if options.control else ACCOUNT
    if account is not None and options.kick is not None:
        account = replace(account, kick=options.kick, kick_angular=ANGULAR * options.kick)
    presets_ = list(known())
    rows = [*presets_, *((f"random {i}", random_profile(rng), False) for i in range(options.sets))]
    drawn: dict[str, list[Draw]] = {}
    for name, profile, rotates in rows:
        row: dict[str, object] = {"axis": name}
        for period, acceleration in BOUNDS:
            scale = ANGULAR if rotates else 1.0
            sampling = Sampling(period, acceleration * scale, scale, rotates, account)
            draw = search(profile, sampling, histories=options.histories, seed=options.seed)
            cycles += draw.cycles
            bound = f"{1e3 * period:g} ms, {acceleration:g} m/s²"
            drawn.setdefault(bound, []).append(draw)
            row[bound] = {key: round(1e3 * getattr(draw, key), 2) for key in QUANTITIES}
        print(json.dumps(row, ensure_ascii=False), flush=True)
    found = {bound: summed_up(draws, len(presets_)) for bound, draws in drawn.items()}
    print(json.dumps({"cycles": cycles, "median / worst": found}, ensure_ascii=False))


def summed_up(draws: list[Draw], known_axes: int) -> dict[str, object]:
    """Median and worst, mJ, of the presets and of the random tunings, and how many axes miss each target."""
    parts = {"presets": draws[:known_axes], "random": draws[known_axes:]}
    return {
        key: {
            part: [round(1e3 * float(f([getattr(d, key) for d in some])), 1) for f in (np.median, np.max)]
            for part, some in parts.items()
            if some
        }
        for key in QUANTITIES
    } | {"beyond 1, 5, 10 mJ a cycle": [sum(d.cycle > 1e-3 * most for d in draws) for most in (1.0, 5.0, 10.0)]}


if __name__ == "__main__":
    main()
