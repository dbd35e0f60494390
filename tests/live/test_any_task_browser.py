"""The page for any task, in windows of three sizes: what is chosen there runs, and scene and controls are seen."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest
from playwright.sync_api import Browser

from pliant.configuration import merged
from pliant.live.page.plots import Plot
from pliant.studies.task.config import TaskCase
from tests.live.conftest import Live, served, until
from tests.live.test_task_dials import task

pytestmark = pytest.mark.study


@pytest.fixture(scope="module")
def shown(browser: Browser, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Live]:
    case = merged(task(), {"path": {"size": (0.10, 0.08)}, "simulation": {"contact": "explicit"}})
    with served(browser, tmp_path_factory.mktemp("logs"), "polish-circle", case) as made:
        yield made


def error_plot(shown: Live) -> Plot:
    return next(plot for plot in shown.page.plots._plots if plot.columns[0] == "error.x")


def config(shown: Live) -> TaskCase:
    found = shown.page.config
    assert isinstance(found, TaskCase)
    return found


def canvas_width(shown: Live) -> float:
    """px of the scene."""
    box = shown.tab.locator("canvas[data-engine]").bounding_box()
    return 0.0 if box is None else box["width"]


def choose(shown: Live, label: str, option: str) -> None:
    """Picks an entry of a list in the browser."""
    box = shown.tab.locator("label", has_text=label).last.locator("xpath=following::input[1]")
    box.scroll_into_view_if_needed()
    box.click()
    shown.tab.get_by_role("option", name=option, exact=True).click()


def test_the_way_of_the_tool_is_coloured_by_its_error(shown: Live) -> None:
    """Points on the table, 1.5 mm above it, with errors of force and path of this size."""
    until(lambda: len(shown.page.trail.errors) > 20, "a way on the surface")
    force, path = np.abs(shown.page.trail.errors[-10:]).T
    assert force.max() < 5.0
    assert path.max() < 5.0
    shown.tab.get_by_text("colour on surface").first.wait_for()
    until(lambda: np.isnan(shown.latest("error.z")), "no position error along the pressed axis")
    until(lambda: error_plot(shown).known == (True, True, False), "curves along x and y alone")
    shown.shoot("any_task")


def test_a_small_window_shows_scene_and_controls(shown: Live) -> None:
    """The curves begin folded, the controls do not; in a wide window (the control) both are open."""
    tab = shown.tab
    tab.get_by_text("force shown").wait_for()
    try:
        for width, height in ((844, 390), (900, 600)):
            tab.set_viewport_size({"width": width, "height": height})
            tab.reload()
            button = tab.get_by_role("button", name="Pause")
            button.wait_for()
            folded = (0.5 * width, width - 300.0)  # beside open controls
            until(lambda folded=folded: folded[0] < canvas_width(shown) < folded[1], "folded curves")
            pause = button.bounding_box()
            assert pause is not None
            assert pause["y"] + pause["height"] < height
            shown.shoot(f"any_task_{width}x{height}")
        tab.get_by_role("button", name="Expand").first.click()
        until(lambda: canvas_width(shown) < 250.0, "the open curves")
        shown.shoot("any_task_900x600_open")
    finally:
        tab.set_viewport_size({"width": 1280, "height": 800})
        tab.reload()
        tab.get_by_text("force shown").wait_for()


def test_tool_robot_and_surface_are_chosen_on_the_page(shown: Live) -> None:
    choose(shown, "tool", "box")
    until(lambda: config(shown).tool.shape == "box", "the other tool")
    until(lambda: shown.time > 0.0 and shown.page.run.ticks > 0, "its run")
    shown.shoot("any_task_box")
    choose(shown, "tool", "sphere")  # a box has no law against a cylinder
    until(lambda: config(shown).tool.shape == "sphere", "the ball again")
    choose(shown, "surface", "cylinder")
    until(lambda: config(shown).surface.shape == "cylinder", "the other surface")
    until(lambda: shown.latest("contact") > 1.0, "its contact")
    shown.shoot("any_task_cylinder")
    choose(shown, "robot", "panda")
    until(lambda: config(shown).robot == "panda", "the other robot")
    until(lambda: shown.time > 0.0, "its run")


def test_what_cannot_be_is_said_and_the_run_before_goes_on(shown: Live) -> None:
    """A path of 4 m: the reason stands on the page, and the control is back at what runs."""
    before = config(shown)
    box = shown.tab.locator("label", has_text="size [m]").locator("xpath=following::input[1]")
    box.fill("4")
    box.press("Enter")
    shown.tab.get_by_text("What ran before runs again.").wait_for()
    assert config(shown) == before
    until(lambda: float(box.input_value()) == before.path.size[0], "the size that runs")
    shown.shoot("any_task_refused")
    assert [text for text in shown.complaints if "WebGL" not in text] == []
