"""What an open page costs the control loop: periods of a paced loop without a page, and with one in a real browser.

    python benchmarks/live_jitter.py [--seconds 8] [--json FILE] [--chromium PATH]

The loop runs in this process, page and browser in others, as with `pliant run --live`. Printed per arm: how far the
time from one control step to the next is off its nominal value, how long planning and control take, and the ratios.
"""

from __future__ import annotations

import argparse
import json
import shutil
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from pliant import loop
from pliant.configuration import merged
from pliant.experiments.registry import get_study
from pliant.live.loop.pace import Pace
from pliant.live.loop.session import Session
from pliant.live.server.launch import page_process
from pliant.signals import Tick

_SKIPPED = 500  # first periods: caches and the browser's start
_FLAGS = ["--no-sandbox", "--disable-quic", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]


class Clockwork:
    """An observer that notes when each tick came and how long its control took."""

    def __init__(self) -> None:
        self.at: list[float] = []
        self.busy: list[float] = []

    def __call__(self, tick: Tick) -> None:
        self.at.append(time.perf_counter())
        self.busy.append(tick.wall["plan"] + tick.wall["control"])

    def report(self, period: float) -> dict[str, float]:
        """Percentiles, µs."""
        off = 1e6 * np.abs(np.diff(self.at[_SKIPPED:]) - period)
        busy = 1e6 * np.array(self.busy[_SKIPPED:])
        return {
            "jitter_p50_us": float(np.percentile(off, 50)),
            "jitter_p99_us": float(np.percentile(off, 99)),
            "jitter_max_us": float(off.max()),
            "control_p50_us": float(np.percentile(busy, 50)),
            "control_p99_us": float(np.percentile(busy, 99)),
            "missed_percent": 100.0 * float(np.mean(busy > 1e6 * period)),
        }


def measured(seconds: float, chromium: str | None) -> dict[str, float]:
    """One arm. Args: chromium: program of a browser that looks on; None: no page at all."""
    study = get_study("stack")
    config = merged(study.case("figure8-wall"), {"duration": seconds})
    experiment = study.build(config)
    clockwork = Clockwork()
    if chromium is None:
        pace = Pace(experiment.plant.period, lambda: None, time.sleep)
        _run(experiment, pace, seconds, [clockwork])
        return clockwork.report(experiment.plant.period)
    links: list[str] = []
    with (
        tempfile.TemporaryDirectory() as folder,
        page_process("127.0.0.1", 0, Path(folder), lambda url, exposed: links.append(url)) as link,
        looking(links[0], chromium),
    ):
        session = Session(study, config, link.send, 1, experiment=experiment, restarts=False)

        def attend() -> None:
            session.announce()
            for message in link.take() if link.waiting else ():
                session.obey(message, pace)

        pace = Pace(experiment.plant.period, attend, link.wait)
        session.observe(pace)
        _run(session.experiment, pace, seconds, [clockwork, session.watch])
    return clockwork.report(experiment.plant.period)


@contextmanager
def looking(url: str, chromium: str) -> Iterator[None]:
    """A headless browser with the page open."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=chromium, headless=True, args=_FLAGS)
        browser.new_page(viewport={"width": 1280, "height": 800}).goto(url)
        time.sleep(2.0)
        yield
        browser.close()


def _run(wired: Any, pace: Pace, seconds: float, observers: list[Any]) -> None:
    ticks = pace(range(round(seconds / wired.plant.period)))
    loop.run(wired.plant, wired.estimator, wired.source, wired.controller, ticks, observers)


def main() -> None:
    parser = argparse.ArgumentParser(description="Jitter of the control loop with a page open, against none.")
    parser.add_argument("--seconds", type=float, default=8.0, help="length of each arm")
    parser.add_argument("--json", type=Path, help="writes the numbers")
    parser.add_argument("--chromium", default=shutil.which("chromium"), help="browser")
    given = parser.parse_args()
    if given.chromium is None:
        parser.error("no chromium found: install it or name it with --chromium")
    arms = {"without": measured(given.seconds, None), "with": measured(given.seconds, given.chromium)}
    ratios = {name: arms["with"][name] / max(arms["without"][name], 1e-9) for name in arms["with"] if "_us" in name}
    print(f"{'':18s}{'no page':>12s}{'page open':>12s}{'ratio':>8s}")
    for name, value in arms["without"].items():
        ratio = f"{ratios[name]:8.2f}" if name in ratios else ""
        print(f"{name:18s}{value:12.1f}{arms['with'][name]:12.1f}{ratio}")
    if given.json:
        given.json.write_text(json.dumps({**arms, "ratio": ratios}, indent=2) + "\n")


if __name__ == "__main__":
    main()
