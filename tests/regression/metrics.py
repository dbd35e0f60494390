"""Metrics of every case at fixed seeds, as the command prints them: what a change of structure must not change.

    python tests/regression/metrics.py record FILE.json [--only TEXT] [--jobs N]
    python tests/regression/metrics.py compare FILE.json [--only TEXT] [--jobs N] [--tolerance 1e-9]

Runs `pliant run` for each row, so that it knows nothing of the package's inside. `compare` prints every metric that
moved by more than the tolerance (relative), and exits 1 if there is one.
"""

from __future__ import annotations

import argparse
import json
import math
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

STACK = "figure8-wall figure8-plain figure8-gazebo figure8-hardware figure8-pushed line-hardware line-pushed line-slow"
STACK += " rest-plain singular calibration balance"
HAPTIC = (
    "floor floor-noise box-top box-tip box-shank ball ball-free ball-unreachable ball-actuator floor-actuator online"
)
HAPTIC += " delay target-sequence random parameters experiment-4 target-stream"
POLISHING = "ideal tables-2-3-4 tables-2-3-4-delayed square slow slow-tilted fast-tilted fast-pushed horizon stiffness"
POLISHING += " force-weight iterations anchor ripple ablation robustness wrong-masses"
POLISHING += " ten-circles stop overshoot torque-loop sensor-mismatch naive"
BASELINES = ("stack-paper", "stack-corrected", "stack-hapfic", "spring", "operational-space")
MPC = ("classical-mpc", "torque-feedback-mpc", "force-feedback-mpc", "offset-free-mpc")

Row = tuple[str, str, str, int]


def rows() -> list[Row]:
    """(study, case, controller or "", seed) of everything that is run."""
    found: list[Row] = [("stack", case, "", 0) for case in STACK.split()]
    found += [("stack", case, "", 1) for case in ("figure8-pushed", "calibration")]
    for case in ("figure8-plain", "figure8-gazebo", "figure8-hardware"):
        found += [("stack", case, name, 0) for name in BASELINES]
    found += [("haptic", case, "", 0) for case in HAPTIC.split()]
    found += [("haptic", case, name, 0) for case in ("floor", "ball") for name in ("haptic-paper", "haptic-hold")]
    found += [("polishing", case, "", 0) for case in POLISHING.split()]
    found += [("polishing", "ideal", name, 0) for name in MPC[:2]]
    found += [("polishing", "tables-2-3-4", name, 1) for name in MPC[:3]]
    found += [("polishing", "tables-2-3-4-delayed", name, 1) for name in MPC]
    found += [("insert-peg", "insert-peg", name, 0) for name in ("haptic", "offset-free-mpc")]
    found += [("wipe-hardening", "wipe-hardening", "", 0)]
    return found


def measured(row: Row) -> dict[str, Any]:
    """Metric → value of one run; "failure" → the sentence where it failed."""
    study, case, controller, seed = row
    with tempfile.TemporaryDirectory() as folder:
        command = [
            str(Path(sys.executable).with_name("pliant")),
            "run",
            study,
            "--case",
            case,
            "--seed",
            str(seed),
            "--out",
            folder,
        ]
        command += ["--controller", controller] if controller else []
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        summary = Path(folder) / "summary.json"
        if not summary.exists():
            return {"failure": done.stderr.strip().splitlines()[-1]}
        (entry,) = json.loads(summary.read_text())["cases"]
        values = {name: metric["value"] for name, metric in entry["metrics"].items()}
        return values if done.returncode == 0 else {**values, "failure": done.stderr.split("the log until")[0].strip()}


def measure_all(only: str, jobs: int) -> dict[str, dict[str, Any]]:
    chosen = [row for row in rows() if only in " ".join(map(str, row))]
    with ThreadPoolExecutor(jobs) as pool:
        found: dict[str, dict[str, Any]] = {}
        for row, values in zip(chosen, pool.map(measured, chosen), strict=True):
            found[" ".join(map(str, row))] = values
            print(" ".join(map(str, row)), "failed" if "failure" in values else "ok", flush=True)
        return found


def differs(old: Any, new: Any, tolerance: float) -> bool:
    if isinstance(old, float | int) and isinstance(new, float | int):
        if math.isnan(old) and math.isnan(new):
            return False
        return abs(new - old) > tolerance * max(abs(old), abs(new), 1e-12)
    return old != new


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("action", choices=["record", "compare"])
    parser.add_argument("file", type=Path)
    parser.add_argument("--only", default="")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--tolerance", type=float, default=1e-9)
    options = parser.parse_args()
    now = measure_all(options.only, options.jobs)
    if options.action == "record":
        options.file.write_text(json.dumps(now, indent=1, ensure_ascii=False) + "\n")
        return 0
    before = json.loads(options.file.read_text())
    moved = 0
    for key, values in now.items():
        for name in sorted({*values, *before[key]}):
            old, new = before[key].get(name), values.get(name)
            if differs(old, new, options.tolerance):
                moved += 1
                print(f"{key}: {name}: {old} -> {new}")
    print(f"{moved} values moved in {len(now)} runs")
    return int(moved > 0)


if __name__ == "__main__":
    sys.exit(main())
