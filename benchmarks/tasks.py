"""A raster on five surfaces with several robots, over seeds: what the tasks that ship ask for, and what comes out.

    python benchmarks/tasks.py                                  iiwa14, panda, ur5e; 3 seeds; about five minutes
    python benchmarks/tasks.py --size 0.12,0.02                 two lines and the turn between them
    python benchmarks/tasks.py --perfect                        perfect arms, surfaces where they are believed
    python benchmarks/tasks.py --controller haptic --seeds 1
    python benchmarks/tasks.py --along estimated                the normal as the path of the contact tells it
    python benchmarks/tasks.py --robots FILE.urdf               another robot; `benchmarks/heavier.py` makes one
    python benchmarks/tasks.py --docs docs/tasks.md matrix      the table goes between <!-- matrix --> and <!-- end -->

One line a run, then a table in Markdown: the mean over the seeds that did not fail of the mean force error, the worst
of the other metrics, and how many runs failed (the arm stopped, no contact found, or a force above `limits.force`).
Ctrl-C prints the table of the runs until then.
"""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
from pathlib import Path

from pliant.configuration import merged
from pliant.errors import PliantError
from pliant.experiments.base import Result
from pliant.experiments.runner import run_case
from pliant.studies.task.study import study_of

TASKS = ("wipe", "wipe-tilted-20", "wipe-tilted-45", "wipe-cylinder", "wipe-sphere")
ROBOTS = ("iiwa14", "panda", "ur5e")
WORST = ("force_error_max", "force_peak", "contact_lost", "path_error", "force_swing", "force_line")
PERFECT = {
    "timing": {"sensing_delay": 0.0, "computation_delay": 0.0},
    "truth": {"shift": 0.0, "tilt": 0.0, "imperfections": "none"},
}


def run(task: str, robot: str, seed: int, asked: argparse.Namespace) -> Result | str:
    """One run, or why it could not begin."""
    study = study_of(task)
    case = merged(study.case(task), {"robot": robot, "controller": asked.controller, "seed": seed})
    if asked.rotors is not None:
        case = merged(case, {"rotor_inertia": asked.rotors})
    if asked.along != "believed":
        case = merged(case, {"force": {"along": asked.along}})
    if asked.size:
        case = merged(case, {"path": {"size": tuple(float(length) for length in asked.size.split(","))}})
    try:
        return run_case(study, merged(case, PERFECT) if asked.perfect else case)
    except PliantError as error:
        return str(error)


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


def table(found: Mapping[tuple[str, str], Sequence[Result | str]]) -> str:
    head = (
        "| task | robot | failed | force_error, N | worst seed | force_error_max, N | force_peak, N | contact_lost, % |"
    )
    rows = [row(*pair, results) for pair, results in found.items() if results]
    head += " path_error, mm | force_swing, % | force_line, % |"
    return "\n".join((head, f"|---|---|{9 * '---:|'}", *rows))


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
    parser.add_argument("--controller", default="offset-free-mpc")
    parser.add_argument("--seeds", type=int, default=None, help="default: 3, or 1 with --perfect")
    parser.add_argument("--rotors", type=float, help="inertia of every joint's motor, kg m²; default: the catalogue's")
    parser.add_argument("--size", default="", help="of the raster, m,m; default: the task's")
    parser.add_argument("--along", default="believed", help="believed or estimated: whose normal the force follows")
    parser.add_argument("--perfect", action="store_true")
    parser.add_argument("--docs", nargs=2, metavar=("FILE", "NAME"), help="where the table is written, too")
    asked = parser.parse_args()
    pairs = [(task, robot) for task in asked.tasks.split(",") for robot in asked.robots.split(",")]
    found: dict[tuple[str, str], list[Result | str]] = {pair: [] for pair in pairs}
    try:
        for seed in range(asked.seeds or (1 if asked.perfect else 3)):
            for task, robot in pairs:
                result = run(task, robot, seed, asked)
                found[task, robot].append(result)
                said = ", ".join(f"{name} {value:.3g}" for name, value in values(result).items())
                print(
                    f"{task} {robot} seed {seed}: {said or 'nothing measured'}; {failure(result) or 'done'}", flush=True
                )
    except KeyboardInterrupt:
        print("interrupted")
    print("\n" + table(found))
    if asked.docs:
        put_into(Path(asked.docs[0]), asked.docs[1], table(found))


if __name__ == "__main__":
    main()
