"""A raster on five surfaces with several robots, over seeds: what the tasks that ship ask for, and what comes out.

    python benchmarks/tasks.py                                  iiwa14, panda, ur5e; 3 seeds; about five minutes
    python benchmarks/tasks.py --size 0.12,0.02                 two lines and the turn between them
    python benchmarks/tasks.py --perfect                        perfect arms, surfaces where they are believed
    python benchmarks/tasks.py --controllers haptic --seeds 1
    python benchmarks/tasks.py --controllers offset-free-mpc,haptic --seeds 10 --jobs 2      several on the same worlds
    python benchmarks/tasks.py --along estimated                the normal as the path of the contact tells it
    python benchmarks/tasks.py --robots FILE.urdf               another robot; `benchmarks/heavier.py` makes one
    python benchmarks/tasks.py --docs docs/tasks.md matrix      the table goes between <!-- matrix --> and <!-- end -->

One line a run, then a table in Markdown: the mean over the seeds that did not fail of the mean force error, the worst
of the other metrics, and how many runs failed (the arm stopped, no contact found, or a force above `limits.force`).
Ctrl-C prints the table of the tasks and robots until then.
"""

from __future__ import annotations

import argparse
import itertools
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import pliant
from pliant.errors import PliantError
from pliant.experiments.base import Result

TASKS = ("wipe", "wipe-tilted-20", "wipe-tilted-45", "wipe-cylinder", "wipe-sphere")
ROBOTS = ("iiwa14", "panda", "ur5e")
WORST = ("force_error_max", "force_peak", "contact_lost", "path_error", "force_swing", "force_line")
PERFECT = {
    "timing.sensing_delay": 0.0,
    "timing.computation_delay": 0.0,
    "truth.shift": 0.0,
    "truth.tilt": 0.0,
    "truth.imperfections": "none",
}
Place = tuple[str, str, str]
"""controller, task, robot"""


def runs(task: str, robot: str, controller: str, asked: argparse.Namespace) -> Sequence[Result | str]:
    """The runs of every seed, or why they could not begin."""
    changes: dict[str, Any] = {"force.along": asked.along} if asked.along != "believed" else {}
    if asked.rotors is not None:
        changes["rotor_inertia"] = asked.rotors
    if asked.size:
        changes["path.size"] = tuple(float(length) for length in asked.size.split(","))
    if asked.perfect:
        changes.update(PERFECT)
    try:
        return pliant.rollout(
            task, seeds=asked.seeds, changes=[changes], controller=controller, robot=robot, jobs=asked.jobs
        ).runs
    except PliantError as error:
        return [str(error)] * asked.seeds


def values(result: Result | str) -> dict[str, float]:
    return {} if isinstance(result, str) else {metric.name: metric.value for metric in result.metrics}


def failure(result: Result | str) -> str | None:
    return result if isinstance(result, str) else result.failure


def row(task: str, robot: str, results: Sequence[Result | str]) -> str:
    good = [values(result) for result in results if failure(result) is None]
    cells = ["–"] * (2 + len(WORST))
    if good:
        errors = [found["force_error"] for found in good]
        cells = [f"{sum(errors) / len(errors):.2f}", f"{max(errors):.2f}"]
        cells += [f"{max(found[name] for found in good):.3g}" for name in WORST]
    return f"| `{task}` | {Path(robot).stem} | {len(results) - len(good)} of {len(results)} | {' | '.join(cells)} |"


def table(found: Mapping[Place, Sequence[Result | str]]) -> str:
    """One table; of several controllers, one after the other under their names."""
    head = (
        "| task | robot | failed | force_error, N | worst seed | force_error_max, N | force_peak, N | contact_lost, % |"
    )
    head += f" path_error, mm | force_swing, % | force_line, % |\n|---|---|{9 * '---:|'}"
    parts: list[str] = []
    names = list(dict.fromkeys(controller for controller, _, _ in found))
    for name in names:
        rows = [row(task, robot, results) for (by, task, robot), results in found.items() if by == name]
        parts.append("\n".join([*([f"**`{name}`**\n"] if len(names) > 1 else []), head, *rows]))
    return "\n\n".join(parts)


def put_into(file: Path, name: str, text: str) -> None:
    """Replaces what stands between the comments `name` and `end` of a Markdown file."""
    before, begin, rest = file.read_text(encoding="utf-8").partition(f"<!-- {name} -->\n")
    _, end, after = rest.partition("<!-- end -->")
    if not begin or not end:
        raise SystemExit(f"{file} has no place <!-- {name} --> … <!-- end -->")
    file.write_text(f"{before}{begin}{text}\n{end}{after}", encoding="utf-8")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tasks", default=",".join(TASKS))
    parser.add_argument("--robots", default=",".join(ROBOTS))
    parser.add_argument("--controllers", default="offset-free-mpc")
    parser.add_argument("--seeds", type=int, default=None, help="default: 3, or 1 with --perfect")
    parser.add_argument("--jobs", type=int, default=1, help="runs at the same time")
    parser.add_argument("--rotors", type=float, help="inertia of every joint's motor, kg m²; default: the catalogue's")
    parser.add_argument("--size", default="", help="of the raster, m,m; default: the task's")
    parser.add_argument("--along", default="believed", help="believed or estimated: whose normal the force follows")
    parser.add_argument("--perfect", action="store_true")
    parser.add_argument("--docs", nargs=2, metavar=("FILE", "NAME"), help="where the table is written, too")
    asked = parser.parse_args()
    asked.seeds = asked.seeds or (1 if asked.perfect else 3)
    places = list(itertools.product(*(names.split(",") for names in (asked.controllers, asked.tasks, asked.robots))))
    found: dict[Place, Sequence[Result | str]] = {}
    try:
        for controller, task, robot in places:
            found[controller, task, robot] = results = runs(task, robot, controller, asked)
            for seed, result in enumerate(results):
                said = ", ".join(f"{name} {value:.3g}" for name, value in values(result).items())
                ended = f"{said or 'nothing measured'}; {failure(result) or 'done'}"
                print(f"{controller} {task} {robot} seed {seed}: {ended}", flush=True)
    except KeyboardInterrupt:
        print("interrupted")
    print("\n" + table(found))
    if asked.docs:
        put_into(Path(asked.docs[0]), asked.docs[1], table(found))


if __name__ == "__main__":
    main()
