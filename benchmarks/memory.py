"""Memory of a long run: the loop, its log, and the metrics that are made of the log.

    python benchmarks/memory.py --seconds 3600

Without figures and without the scene for 3-D viewers.
"""

from __future__ import annotations

import argparse
import gc
import resource
import tempfile
import time
from pathlib import Path

from pliant.compiled import Rows
from pliant.configuration import merged
from pliant.experiments.registry import get_study
from pliant.experiments.runner import run_info
from pliant.experiments.verdict import physical_verdict
from pliant.signals import Tick
from pliant.telemetry.recorder import Recorder


class _Noted:
    """Observer that notes the memory every so many ticks, made in Python or in blocks."""

    def __init__(self, every: int) -> None:
        self.single, self._every, self._count = 0, every, 0

    def __call__(self, tick: Tick) -> None:
        self.single += 1
        self._add(1, tick.measurement.time)

    def take_block(self, rows: Rows) -> None:
        self._add(len(rows.numbers), rows.first().measurement.time)

    def _add(self, ticks: int, seconds: float) -> None:
        if self._count // self._every < (self._count + ticks) // self._every:
            note(f"loop, {seconds:.0f} s")
        self._count += ticks


def now() -> float:
    """MB that the process has in memory."""
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * resource.getpagesize() / 1e6


def note(what: str) -> None:
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024.0 / 1e6
    print(f"{what:28s} {now():6.0f} MB, peak {peak:6.0f} MB, CPU {time.process_time():6.1f} s", flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--study", default="stack")
    parser.add_argument("--case", default="figure8-plain")
    parser.add_argument("--postures", type=int, default=10, help="s of path that are solved before; it repeats")
    parser.add_argument("--seconds", type=int, default=600, help="s of the run")
    args = parser.parse_args()
    study = get_study(args.study)
    config = merged(study.case(args.case), {"duration": float(args.seconds)})
    wired = study.build(merged(config, {"duration": float(args.postures)}))  # they take time
    note("built")
    ticks = round(args.seconds / wired.plant.period)
    noted = _Noted(ticks // 10)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "long.mcap"
        with Recorder(path, run_info(study, config, wired), channels=wired.channels) as recorder:
            outcome = wired.run(range(ticks), [recorder, noted])
        note(f"log of {args.seconds} s")
        print(f"{outcome.ticks} ticks, {noted.single} of them in Python; {outcome.failure or 'no failure'}")
        gc.collect()
        print(f"the file has {path.stat().st_size / 1e6:.0f} MB")
        log = recorder.log()
        note("log opened")
        metrics = study.judged(config, log)
        note(f"{len(metrics)} metrics")
        physical_verdict(log, wired.robot)
        note("verdict")


if __name__ == "__main__":
    main()
