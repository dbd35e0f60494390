"""Force and speed of a running task, turned by sliders on the first tab of the page in a real browser."""

from __future__ import annotations

import re
from collections.abc import Iterator

import numpy as np
import pytest
from playwright.sync_api import Browser

from tests.live.conftest import Live, drag, served, until
from tests.live.test_task_dials import task

pytestmark = pytest.mark.study


@pytest.fixture(scope="module")
def shown(browser: Browser, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Live]:
    with served(browser, tmp_path_factory.mktemp("logs"), "polish-circle", task()) as made:
        yield made


def test_the_force_of_a_task_is_turned_on_the_first_tab(shown: Live) -> None:
    """In newtons, up to its limit of 40 N: dragged to the right, the contact follows."""
    shown.tab.get_by_text("force [N]").first.wait_for()
    shown.tab.get_by_text("speed [m/s]").first.wait_for()
    until(lambda: shown.latest("contact") > 18.0, "the force of the task")
    shown.shoot("task_before")
    believed(shown)
    drag(shown, "force [N]", 0.75)  # of 0 to 40 N
    until(lambda: shown.latest("contact") > 27.0, "more force")
    shown.settle(0.5)
    assert shown.latest("contact") == pytest.approx(30.0, abs=2.5)
    shown.shoot("task_force")
    assert shown.complaints == []


def believed(shown: Live) -> None:
    """The first tab says the stiffness that the controller believes; once it has pressed, near the table's 2e4 N/m."""
    line = shown.tab.get_by_text("estimated at").first
    line.wait_for()

    def stiffness() -> float:
        found = re.search(r"stiffness ([\d.e+]+) ±", line.inner_text())
        return float(found[1]) if found else 0.0

    until(lambda: stiffness() == pytest.approx(2e4, rel=0.15), "the stiffness of the table")


def test_the_speed_of_a_task_is_turned_on_the_first_tab(shown: Live) -> None:
    """From 0.05 to near its slowest: the handle in the scene, which is the reference, creeps."""

    def speed() -> float:
        """m/s of the reference's place over 0.3 s of simulated time."""
        before, time = np.array(shown.page.target.handle.position), shown.time
        shown.settle(0.3)
        return float(np.linalg.norm(np.array(shown.page.target.handle.position) - before)) / (shown.time - time)

    until(lambda: shown.latest("contact") > 18.0, "the force of the task")
    shown.settle(0.6)
    until(lambda: speed() == pytest.approx(0.05, rel=0.35), "the speed of the task")  # of pictures that may come late
    drag(shown, "speed [m/s]", 0.02)
    shown.settle(1.0)  # the rate changes by 1 a second
    slow = speed()
    assert slow < 0.02
    shown.shoot("task_speed")
    assert shown.complaints == []
