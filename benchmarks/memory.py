"""Memory of a long run: the loop, its log, and the metrics that are made of the log.

    python benchmarks/memory.py --seconds 600

The loop runs for some time; then the ticks of its last second are recorded over and over, until the log is as long as
asked, and measured. Without figures and without the scene for 3-D viewers.
"""

from __future__ import annotations

import argparse
import gc
import resource
import tempfile
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from pliant.configuration import merged
from pliant.experiments.registry import get_study
from pliant.experiments.runner import run_info
from pliant.experiments.verdict import physical_verdict
from pliant.signals import Tick
from pliant.telemetry.recorder import Recorder


class _Last:
    """Observer that keeps the latest ticks, and notes the memory as the loop goes."""

    def __init__(self, kept: int, note: Callable[[str], None]) -> None:
        self.ticks: list[Tick] = []
        self._kept, self._note, self._count = kept, note, 0

    def __call__(self, tick: Tick) -> None:
        self.ticks.append(tick)
        del self.ticks[: -self._kept]
        self._count += 1
        if self._count % (10 * self._kept) == 0:
            self._note(f"loop, {tick.measurement.time:.0f} s")


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
    parser.add_argument("--loop", type=int, default=60, help="s of the loop")
    parser.add_argument("--seconds", type=int, default=600, help="s of the log")
    args = parser.parse_args()
    study = get_study(args.study)
    config = merged(study.case(args.case), {"duration": float(args.seconds)})
    wired = study.build(merged(config, {"duration": float(args.loop)}))  # its postures take time
    note("built")
    second = round(1.0 / wired.plant.period)
    last = _Last(second, note)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "long.mcap"
        with Recorder(path, run_info(study, config, wired), channels=wired.channels) as recorder:
            wired.run(range(args.loop * second), [recorder, last])
            for past in range(1, args.seconds - args.loop + 1):
                for tick in last.ticks:
                    moved = replace(tick.measurement, time=tick.measurement.time + past)
                    recorder(replace(tick, measurement=moved))
        note(f"log of {args.seconds} s")
        del last
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
