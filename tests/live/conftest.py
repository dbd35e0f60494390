"""A page, its loop, and a real browser without a screen."""

from __future__ import annotations

import os
import shutil
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("viser", reason="the live page is not installed (pliant[live])")
playwright = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")

from playwright.sync_api import Browser  # noqa: E402
from playwright.sync_api import Page as Tab  # noqa: E402

from pliant.configuration import merged  # noqa: E402
from pliant.experiments.base import CaseConfig  # noqa: E402
from pliant.experiments.registry import get_study  # noqa: E402
from pliant.live.page.page import Page  # noqa: E402
from pliant.live.server.launch import live_page  # noqa: E402
from pliant.live.server.web import PageServer  # noqa: E402

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
_FLAGS = [
    "--no-sandbox", "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update",
    "--disable-sync", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
    "--disable-backgrounding-occluded-windows", "--disable-renderer-backgrounding",
    "--disable-background-timer-throttling", "--disable-extensions",
]  # fmt: skip
_FEW_PIXELS = 0.35  # a unit of length of the page: the processor draws here
_CHEAP_PICTURES = """
const soon = window.requestAnimationFrame.bind(window);
let picture = 0;
window.requestAnimationFrame = (draw) => setTimeout(() => { picture += 1; soon(draw); }, 150);
window.cancelAnimationFrame = (handle) => clearTimeout(handle);
const open = HTMLCanvasElement.prototype.getContext;
HTMLCanvasElement.prototype.getContext = function (kind, asked) {
  return open.call(this, kind, kind.startsWith("webgl") ? {...asked, antialias: false} : asked);
};
for (const name of ["drawArrays", "drawElements", "drawArraysInstanced", "drawElementsInstanced"]) {
  const drawn = WebGL2RenderingContext.prototype[name];
  WebGL2RenderingContext.prototype[name] = function (...what) {
    if (picture % 20 === 0) drawn.apply(this, what);
  };
}
"""  # the scene is laid out six times a second, without smooth edges, and one in twenty is drawn: the processor draws
PATIENCE = 100.0  # s: other work may share the machine


def until(holds: Callable[[], object], what: str, seconds: float = PATIENCE) -> None:
    """Waits until something holds."""
    end = time.monotonic() + seconds
    while not holds():
        assert time.monotonic() < end, f"{what} did not happen within {seconds:g} s"
        time.sleep(0.02)


def new_tab(browser: Browser, width: int, height: int) -> Tab:
    """A tab of this size; all of its pixels and pictures are drawn where pictures are asked for."""
    asked = bool(os.environ.get("PLIANT_SCREENSHOTS"))
    tab = browser.new_page(
        viewport={"width": width, "height": height}, device_scale_factor=1.0 if asked else _FEW_PIXELS
    )
    if not asked:
        tab.add_init_script(_CHEAP_PICTURES)
    tab.set_default_timeout(1e3 * PATIENCE)
    return tab


@pytest.fixture(scope="session")
def browser() -> Iterator[Browser]:
    if CHROMIUM is None:
        pytest.skip("chromium is not installed")
    with playwright.sync_playwright() as driver:
        started = driver.chromium.launch(executable_path=CHROMIUM, headless=True, args=_FLAGS)
        yield started
        started.close()


def wall_case() -> CaseConfig:
    """The arm holds its tool beside a wall, without joint friction: forces are what the controller says."""
    study = get_study("stack")
    changes = {"path": {"kind": "hold", "ramp": 0.0}, "duration": 60.0, "joints": {"friction": 0.0, "damping": 1.0}}
    return merged(study.case("figure8-wall"), changes)


@dataclass
class Live:
    """A served page with its loop, and a browser's tab on it."""

    server: PageServer
    page: Page
    tab: Tab
    folder: Path
    complaints: list[str] = field(default_factory=list)
    """errors in the browser's console"""

    def open_tab(self, name: str) -> None:
        self.tab.get_by_role("tab", name=name).click()

    def latest(self, column: str) -> float:
        return self.page.plots.latest(column)

    @property
    def time(self) -> float:
        """s of simulated time that the page knows of."""
        rows = self.page.plots.rows
        return float(rows[-1, 0]) if len(rows) else -1.0

    def settle(self, seconds: float) -> None:
        """Lets simulated time pass; a run that begins again in between starts from what has passed before."""
        passed, last = 0.0, self.time

        def enough() -> bool:
            nonlocal passed, last
            now = self.time
            passed, last = passed + max(now - last, 0.0), now
            return passed >= seconds

        until(enough, f"{seconds:g} s of simulated time")

    def column(self, name: str) -> np.ndarray:
        rows = self.page.plots.rows
        return rows[:, self.page.plots.names.index(name)]

    def shoot(self, name: str) -> None:
        """Takes a picture of the page, if a folder is given for it."""
        folder = os.environ.get("PLIANT_SCREENSHOTS")
        if folder:
            note = self.tab.get_by_text("Software WebGL rendering detected")
            if note.count():
                note.locator("xpath=ancestor::*[@role='alert']").locator("button").first.click()
                note.wait_for(state="detached")
            self.tab.screenshot(path=Path(folder) / f"live_{name}.png")


def drag(live: Live, label: str, share: float) -> None:
    """Drags the thumb of a slider with the mouse, again if the page has not followed.

    Args: label: how it begins; share: of the track, from the left.
    """
    text = live.tab.locator("label", has_text=label).first
    slider = text.locator("xpath=following::*[@role='slider'][1]")
    slider.wait_for()
    before, mouse = slider.get_attribute("aria-valuenow"), live.tab.mouse
    for _ in range(5):
        here = slider.bounding_box()
        track = slider.locator("xpath=..").bounding_box()
        assert here is not None
        assert track is not None
        y = here["y"] + here["height"] / 2
        mouse.move(here["x"] + here["width"] / 2, y)
        mouse.down()
        mouse.move(track["x"] + share * track["width"], y, steps=3)
        mouse.up()
        if slider.get_attribute("aria-valuenow") != before:
            return
    raise AssertionError(f"the slider {label} stays at {before}")


@pytest.fixture(scope="module")
def live(browser: Browser, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Live]:
    """One page for the tests of a module; every test leaves it playing."""
    with served(browser, tmp_path_factory.mktemp("logs"), "stack", wall_case()) as made:
        yield made


@contextmanager
def served(browser: Browser, folder: Path, study: str, case: CaseConfig) -> Iterator[Live]:
    """A page that shows a case, from its first samples on."""
    with PageServer("127.0.0.1", 0) as server, live_page(server, folder) as page:
        page.run.start(study, case)
        thread = threading.Thread(target=page.serve, daemon=True)
        thread.start()
        tab = new_tab(browser, 1280, 800)
        made = Live(server, page, tab, folder)
        tab.on("pageerror", lambda error: made.complaints.append(str(error)))
        tab.on("console", lambda note: made.complaints.append(note.text) if note.type == "error" else None)
        try:
            tab.goto(server.url)
            until(lambda: made.time > 0.0, "the first samples")
            yield made
        finally:
            tab.close()
            page.stop()
            thread.join(PATIENCE)
