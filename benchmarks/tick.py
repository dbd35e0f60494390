"""Where a tick's time goes, and how that compares with another version of pliant beside it.

    python benchmarks/tick.py --against OTHER_ENVIRONMENT/bin/python --write docs/performance.md

Each run is a child process of one of the two Pythons, one after the other, so that what else the machine does meets
both; a ratio is the median over rounds of the ratio within a round. Times are CPU time of the loop's thread. A clock of
CPU time is a call into the system, and fourteen of them a tick take up to a third of a tick: so the loop and the run
as a whole are timed in a run of their own, without a look at their parts.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import os
import platform
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from statistics import median
from typing import Any

CASES: dict[str, tuple[str, ...]] = {
    "polishing, delayed, offset-free": ("polishing", "tables-2-3-4-delayed", "offset-free-mpc", "5.0"),
    "polishing, delayed, force feedback": ("polishing", "tables-2-3-4-delayed", "force-feedback-mpc", "5.0"),
    "stack figure8-plain": ("stack", "figure8-plain", "stack", "4.0"),
    "haptic floor": ("haptic", "floor", "haptic", "8.2"),
}
"""name → study, case, controller, s of simulated time"""
PARTS = ("plant", "estimator", "source", "controller", "recorder")
BEGIN, END = "<!-- measured: begin -->", "<!-- measured: end -->"
US = 1e6  # µs per s


class Timed:
    """A part of the loop whose steps are timed; everything else is the part's."""

    def __init__(self, part: Any) -> None:
        self.part, self.taken = part, list[float]()

    def __getattr__(self, name: str) -> Any:
        return getattr(self.part, name)

    def step(self, *inputs: Any) -> Any:
        begin = time.thread_time()
        answer = self.part.step(*inputs)
        self.taken.append(time.thread_time() - begin)
        return answer


def core_of(controller: Any) -> tuple[Any, str]:
    """The innermost controller's holder and the attribute that it stands in."""
    holder = controller
    while hasattr(holder.inner, "inner"):
        holder = holder.inner
    return holder, "inner"


def whole_loop(plain: Callable[..., Any], found: dict[str, Any]) -> Callable[..., Any]:
    """A loop's run that is timed as it is."""

    def run(*inputs: Any) -> Any:
        begin = time.thread_time()
        outcome = plain(*inputs)
        found["loop"], found["ticks"] = time.thread_time() - begin, outcome.ticks
        return outcome

    return run


def parted_loop(plain: Callable[..., Any], found: dict[str, Any]) -> Callable[..., Any]:
    """A loop's run whose parts are timed."""

    def run(plant: Any, estimator: Any, source: Any, control: Any, clock: Any, observers: Any = (), *more: Any) -> Any:
        core = None
        if hasattr(control, "inner"):
            holder, name = core_of(control)
            core = Timed(getattr(holder, name))
            setattr(holder, name, core)
        parts = [Timed(part) for part in (plant, estimator, source, control)]
        recorded: list[float] = []

        def watch(tick: Any, recorder: Any = observers[0]) -> None:
            begin = time.thread_time()
            recorder(tick)
            recorded.append(time.thread_time() - begin)

        outcome = plain(*parts, clock, [watch, *observers[1:]], *more)
        found["parts"] = dict(zip(PARTS, [*(part.taken for part in parts), recorded], strict=True))
        found["core"] = (core or parts[3]).taken
        return outcome

    return run


def worker(study: str, case: str, controller: str, duration: str, look: str) -> dict[str, Any]:
    """One run by the command line's own way, with its loop timed. Needs no other function of the package.

    Args:
        look: "parts": times the parts of the loop; "whole": the loop and what is round it.
    """
    from pliant import loop
    from pliant.cli import run as command
    from pliant.cli.app import main

    found: dict[str, Any] = {}

    def run_case(study: Any, *rest: Any, plain_case: Callable[..., Any] = command.run_case, **more: Any) -> Any:
        drawn: list[float] = []
        figures = study.figures

        def draw(*inputs: Any) -> Any:
            begin = time.process_time()
            files = figures(*inputs)
            drawn.append(time.process_time() - begin)
            return files

        study.figures = draw
        begin = time.process_time()
        result = plain_case(study, *rest, **more)
        found["measured"] = time.process_time() - begin - sum(drawn)
        return result

    loop.run = (parted_loop if look == "parts" else whole_loop)(loop.run, found)
    command.run_case = run_case
    with tempfile.TemporaryDirectory() as folder:
        argv = ["run", study, "--case", case, "--controller", controller, "--out", folder]
        sys.argv = ["pliant", *argv, "--set", f"duration={duration}"]
        begin = sum(os.times()[:4])  # with children that have ended: pictures of a scene are drawn in one
        with contextlib.suppress(SystemExit):
            main()
        found["run"] = sum(os.times()[:4]) - begin
        found["log"] = sum(path.stat().st_size for path in Path(folder).rglob("*.mcap"))
    found["peak"] = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024.0
    return parts_of(found, controller.endswith("mpc")) if look == "parts" else whole_of(found, float(duration))


def parts_of(found: dict[str, Any], solves: bool) -> dict[str, float]:
    """µs of the parts of a tick. A predictive controller's step that solves takes more than twice a short one's
    time."""
    core = sorted(found["core"])
    limit = 2.0 * core[len(core) // 20]
    quick, long = [taken for taken in core if taken <= limit], [taken for taken in core if taken > limit]
    steps = {"controller's own step": US * median(core), "the same, p99": US * percentile(core, 0.99)}
    if solves:
        steps = {
            "step without solve": US * median(quick),
            "step that solves": US * median(long),
            "step that solves, p99": US * percentile(long, 0.99),
        }
    return {**steps, **{part: US * sum(taken) / len(taken) for part, taken in found["parts"].items()}}


def whole_of(found: dict[str, Any], duration: float) -> dict[str, float]:
    """µs, s and MB of a run."""
    return {
        "tick of the loop": US * found["loop"] / found["ticks"],
        "loop: CPU s per simulated s": found["loop"] / duration,
        "loop with log and metrics, CPU s": found["measured"],
        "whole run, CPU s": found["run"],
        "log, MB": found["log"] / 1e6,
        "peak memory, MB": found["peak"] / 1e6,
    }


def percentile(values: Sequence[float], share: float) -> float:
    return sorted(values)[min(int(share * len(values)), len(values) - 1)]


def measured(python: str, case: Sequence[str]) -> dict[str, float]:
    environment = os.environ | {"OMP_NUM_THREADS": "1", "MPLBACKEND": "agg"}
    rows: dict[str, float] = {}
    for look in ("parts", "whole"):
        call = [python, __file__, "worker", *case, look]
        done = subprocess.run(call, env=environment, capture_output=True, text=True, check=False)
        try:
            rows |= json.loads(done.stdout.splitlines()[-1])
        except (IndexError, ValueError):
            raise SystemExit(f"{' '.join(call)} gave no numbers:\n{done.stderr[-2000:]}") from None
    return rows


def compared(rounds: int, against: str | None, names: Sequence[str]) -> dict[str, dict[str, tuple[float, ...]]]:
    """Case → row → median here, and with another Python the median there and that of the ratios."""
    found: dict[str, dict[str, tuple[float, ...]]] = {}
    for name in names:
        here: list[dict[str, float]] = []
        there: list[dict[str, float]] = []
        for _ in range(rounds):
            here.append(measured(sys.executable, CASES[name]))
            if against:
                there.append(measured(against, CASES[name]))
        found[name] = {}
        for row in here[0]:
            own = median(one[row] for one in here)
            found[name][row] = (own,)
            if against:
                ratios = [a[row] / b[row] if b[row] else 1.0 for a, b in zip(here, there, strict=True)]
                found[name][row] = (own, median(one[row] for one in there), median(ratios))
        print(as_text({name: found[name]}, rounds), file=sys.stderr)  # a long run is not lost with its last case
    return found


def as_text(found: dict[str, dict[str, tuple[float, ...]]], rounds: int) -> str:
    """Markdown tables, one per case."""
    parts = [f"{machine()}; medians of {rounds} rounds, CPU µs a tick where nothing else is said."]
    for name, rows in found.items():
        both = len(next(iter(rows.values()))) == 3
        head = "| | here | there | here / there |\n|---|---:|---:|---:|" if both else "| | here |\n|---|---:|"
        lines = [f"| {row} | " + " | ".join(f"{value:.3g}" for value in values) + " |" for row, values in rows.items()]
        parts.append("\n".join([f"**{name}** ({CASES[name][3]} s simulated)\n", head, *lines]))
    return "\n\n".join(parts)


def machine() -> str:
    info = Path("/proc/cpuinfo")
    names = [line.split(":", 1)[1].strip() for line in info.read_text().splitlines() if line.startswith("model name")]
    model = names[0] if names else platform.processor()
    return f"{model}, Python {platform.python_version()}, load average {os.getloadavg()[0]:.1f}"


def main() -> None:
    if sys.argv[1:2] == ["worker"]:
        print(json.dumps(worker(*sys.argv[2:7])))
        return
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--against", help="Python of an environment with another version")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--cases", nargs="*", default=list(CASES), help="names, or their beginnings")
    parser.add_argument("--write", type=Path, help="page whose measured part is replaced")
    args = parser.parse_args()
    names = [name for name in CASES if any(name.startswith(begin) for begin in args.cases)]
    text = as_text(compared(args.rounds, args.against, names), args.rounds)
    if args.write is None:
        print(text)
        return
    page = args.write.read_text(encoding="utf-8")
    before, rest = page.split(BEGIN)
    args.write.write_text(f"{before}{BEGIN}\n\n{text}\n\n{END}{rest.split(END)[1]}", encoding="utf-8")


if __name__ == "__main__":
    main()
