"""A peg in a hole that stands elsewhere than believed: how often it goes in, and with which forces on its sides.

    python -m benchmarks.insertion                              haptic and offset-free-mpc, 20 seeds; ten minutes
    python -m benchmarks.insertion --seeds 5 --first 5          the seeds 5 to 9
    python -m benchmarks.insertion --controllers haptic
    python -m benchmarks.insertion --docs docs/tasks.md insertion    the table goes into a Markdown file, too

One line a run, then a table: how many runs reached the depth, and of those the mean and (in brackets) the largest over
the seeds of the largest force and moment across the hole's axis, the largest force, and the time that it took.
"""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
from pathlib import Path

import pliant
from benchmarks.tasks import put_into
from pliant.face.result import RunResult

TASK, PHASE = "insert-peg", "insert"
NAMES = (f"{PHASE}/side_force_max", f"{PHASE}/side_moment_max", "force_peak")


def values(made: RunResult) -> list[float]:
    """Of `NAMES`, and s that the phase took."""
    begins = [time for time, _ in made.log.phases()]
    names = [name for _, name in made.log.phases()]
    place = names.index(PHASE)
    return [made.metrics[name].value for name in NAMES] + [begins[place + 1] - begins[place]]


def cell(found: Sequence[float]) -> str:
    return f"{sum(found) / len(found):.2g} ({max(found):.2g})" if found else "–"


def table(found: Mapping[str, Sequence[Sequence[float] | None]]) -> str:
    head = "| controller | went in | side force, N | side moment, N·m | force_peak, N | time, s |"
    rows = [head, "|---|" + 5 * "---:|"]
    for controller, runs in found.items():
        good = [run for run in runs if run is not None]
        cells = [cell([run[place] for run in good]) for place in range(len(NAMES) + 1)]
        rows.append(f"| `{controller}` | {len(good)} of {len(runs)} | {' | '.join(cells)} |")
    return "\n".join(rows)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--controllers", default="haptic,offset-free-mpc")
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--docs", nargs=2, metavar=("FILE", "NAME"), help="where the table is written, too")
    asked = parser.parse_args()
    found: dict[str, list[list[float] | None]] = {name: [] for name in asked.controllers.split(",")}
    for seed in range(asked.first, asked.first + asked.seeds):
        for controller, runs in found.items():
            made = pliant.run(TASK, controller=controller, seed=seed)
            runs.append(None if made.failure else values(made))
            said = ", ".join(f"{value:.3g}" for value in runs[-1] or ())
            print(f"{controller} seed {seed}: {made.failure or said}", flush=True)
    print("\n" + table(found))
    if asked.docs:
        put_into(Path(asked.docs[0]), asked.docs[1], table(found))


if __name__ == "__main__":
    main()
