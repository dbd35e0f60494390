"""How every case of every study begins: joint positions and torques after 300 periods, for each of its controllers.

    python tests/regression/short_runs.py record     writes short_runs.json beside this file
    python tests/regression/short_runs.py compare    prints what moved, and exits 1 if something did

A change of structure moves nothing; where a law or a robot changes, record anew and say so in the CHANGELOG.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from pliant import loop
from pliant.experiments.registry import get_study, study_names
from pliant.signals import Tick

RECORDED = Path(__file__).with_name("short_runs.json")
TICKS = 300
TOLERANCE = 1e-6
"""rad, and of the torque a share of the largest; instruction sets agree to 1e-9 a solve"""
Values = dict[str, list[float]]


def starts() -> Iterator[tuple[str, Any, Any]]:
    """(name, study, configuration) of each controller in the rows of each case."""
    for name in study_names():
        study = get_study(name)
        if not type(study).__module__.startswith("pliant."):
            continue  # one that a test brings
        for case in study.cases:
            base = study.case(case)
            first = {config.controller: config for config in reversed([base, *study.runs(case, 1)])}
            for controller in sorted(first):
                yield f"{name}/{case}/{controller}", study, first[controller]


def begun(study: Any, config: Any) -> Values:
    """q (rad) and torque (N·m) of the last of the first 300 periods, or of the one before the run failed."""
    wired = study.build(config)
    last: list[Tick] = []

    def keep(tick: Tick) -> None:
        last[:] = [tick]

    loop.run(wired.plant, wired.estimator, wired.source, wired.controller, range(TICKS), [keep], wired.robot)
    (tick,) = last
    return {"q": tick.truth.q.tolist(), "torque": np.asarray(tick.command.torque).tolist()}


def moved(was: Values, now: Values) -> float:
    """The larger of the difference of q in rad and of the torque as a share of its largest; inf: another shape."""
    if any(len(was[key]) != len(now[key]) for key in was):
        return float("inf")
    q = np.abs(np.subtract(was["q"], now["q"])).max()
    torque = np.abs(np.subtract(was["torque"], now["torque"])).max() / max(1.0, np.abs(was["torque"]).max())
    return float(max(q, torque))


def recorded() -> dict[str, Values]:
    return json.loads(RECORDED.read_text())


def _main(command: str) -> int:
    found = {name: begun(study, config) for name, study, config in starts()}
    if command == "record":
        RECORDED.write_text(json.dumps(found, indent=None, separators=(",", ":")).replace("},", "},\n") + "\n")
        return 0
    was = recorded()
    far = {name: moved(was[name], now) if name in was else float("inf") for name, now in found.items()}
    for name, by in far.items():
        if by > TOLERANCE:
            print(f"{name}: {by:.2g}")
    gone = sorted(set(was) - set(found))
    print(f"{len(found)} starts, {sum(by > TOLERANCE for by in far.values())} moved, gone: {gone}")
    return int(bool(gone) or any(by > TOLERANCE for by in far.values()))


if __name__ == "__main__":
    sys.exit(_main(sys.argv[1]))
