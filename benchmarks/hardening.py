"""A path from a soft to a stiff place of a table, with and without the estimate of the stiffness on the way.

    python -m benchmarks.hardening                              three seeds of `wipe-hardening`; a few minutes
    python -m benchmarks.hardening --docs docs/tasks.md hardening    the table goes into a Markdown file, too

Each cell is the mean over the seeds and, in brackets, the worst of them.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import pliant
from benchmarks.tasks import put_into

TASK = "wipe-hardening"
METRICS = ("force_error", "force_error_max", "force_peak", "contact_lost", "force_swing")
_DAMPING = {"control.offset-free-mpc.compensation.environment_damping": True}
VARIANTS: dict[str, dict[str, bool]] = {
    "stiffness estimated on the way": {"estimation.changing": True},
    "estimated below 0.02 m/s only": {"estimation.changing": False},
    "stiffness and damping on the way": {"estimation.changing": True, **_DAMPING},
}


def row(name: str, seeds: int) -> str:
    runs = [pliant.run(TASK, seed=seed, **VARIANTS[name]) for seed in range(seeds)]
    for seed, made in enumerate(runs):
        print(f"{name} seed {seed}: {made.failure or {key: made.metrics[key].value for key in METRICS}}", flush=True)
    failed = sum(made.failure is not None for made in runs)
    found = [[made.metrics[key].value for made in runs if made.failure is None] for key in METRICS]
    cells = [f"{sum(values) / len(values):.2f} ({max(values):.2f})" if values else "–" for values in found]
    return f"| {name} | {failed} of {seeds} | {' | '.join(cells)} |"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--docs", nargs=2, metavar=("FILE", "NAME"), help="where the table is written, too")
    asked = parser.parse_args()
    units = ("N", "N", "N", "%", "%")
    head = " | ".join(f"{key}, {unit}" for key, unit in zip(METRICS, units, strict=True))
    lines = [f"| {TASK} | failed | {head} |", "|---|" + (1 + len(METRICS)) * "---:|"]
    table = "\n".join([*lines, *(row(name, asked.seeds) for name in VARIANTS)])
    print("\n" + table)
    if asked.docs:
        put_into(Path(asked.docs[0]), asked.docs[1], table)


if __name__ == "__main__":
    main()
