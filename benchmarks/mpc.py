"""Times of the predictive controllers as JSON, and a figure of how they grow.

Run: OMP_NUM_THREADS=1 python benchmarks/mpc.py [--solves N] [--out FOLDER]
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from pliant.mpc.benchmark import run


def draw(result: dict[str, Any], file: Path) -> None:
    """Time per iteration against horizon, joints and contact dimension."""
    figure = Figure(figsize=(9.0, 2.8), layout="constrained")
    figure.suptitle(f"force feedback, {result['robot']}, {result['instruction_set']}", fontsize=10)
    for ax, (name, points) in zip(figure.subplots(1, 3), result["growth"].items(), strict=True):
        ax.plot([p["x"] for p in points], [p["per_iteration"] for p in points], "o-", label="per iteration")
        ax.plot([p["x"] for p in points], [p["solve"] for p in points], "s--", label="per solve")
        ax.set(xlabel=name, ylabel="CPU time, µs", ylim=(0.0, None))
        ax.grid(alpha=0.3)
    figure.axes[0].legend(frameon=False, fontsize=8)
    figure.savefig(file, dpi=150)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--solves", type=int, default=2000)
    parser.add_argument("--out", type=Path, default=Path())
    arguments = parser.parse_args()
    result = run(arguments.solves)
    arguments.out.mkdir(parents=True, exist_ok=True)
    (arguments.out / "mpc.json").write_text(json.dumps(result, indent=2, ensure_ascii=False) + "\n")
    draw(result, arguments.out / "mpc_growth.png")
    print(json.dumps({"yardstick": result["yardstick"], "cases": result["cases"]}, indent=2, ensure_ascii=False))


if __name__ == "__main__":
    main()
