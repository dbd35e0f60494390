"""The page in a real browser: what is turned there happens in the loop, what happens in the loop shows there."""

from __future__ import annotations

import threading
import time

import numpy as np
import pytest

from pliant.live.page.logged_scene import LoggedScene
from pliant.live.page.replay import ReplayPage
from pliant.live.server.web import PageServer
from pliant.telemetry.log import Log
from tests.live.conftest import PATIENCE, Live, drag, new_tab, until

pytestmark = pytest.mark.study


def test_the_page_loads_without_errors(live: Live) -> None:
    live.tab.get_by_text("playing").wait_for()
    for text in ("force, N", "position error, mm", "energy, J"):
        live.tab.get_by_text(text, exact=True).wait_for()
    live.settle(2.0)
    live.shoot("run")
    live.open_tab("Effort")
    live.tab.get_by_text("torque, N·m", exact=True).wait_for()
    live.open_tab("Contact")
    assert live.complaints == []


def test_a_typed_target_moves_the_robot_onto_the_wall(live: Live) -> None:
    """The offset is typed in the browser; the wall at x = 0.07 m stops the tool, and the force grows to its bound."""
    live.open_tab("Touch")
    box = live.tab.locator("label", has_text="offset").locator("xpath=following::input[@type='text'][1]")
    before = live.latest("contact")
    box.fill("0.25")
    box.press("Enter")
    until(lambda: live.latest("contact") > before + 50.0, "contact")
    live.settle(1.5)
    assert live.latest("contact") == pytest.approx(bound(live), rel=0.15)
    live.shoot("touch")


def bound(live: Live) -> float:
    """F_max of the tool's task as the page believes it."""
    config = live.page.config
    assert config is not None
    return float(config.parameters().tasks["ee"].translation.force_max)  # type: ignore[attr-defined]


def test_a_slider_changes_the_running_controller(live: Live) -> None:
    """F_max turned down in the browser while the tool presses: the force follows within the study's settling time."""
    live.open_tab("Tune")
    pressed, old = live.latest("contact"), bound(live)
    drag(live, "force max", 0.43)
    until(lambda: bound(live) < old - 10.0, "a new bound")
    live.settle(1.0)
    new = bound(live)
    for axis in "xyz":
        assert abs(live.latest(f"commanded.{axis}")) <= new * (1.0 + 1e-9)
    assert abs(live.latest("commanded.x")) > 0.95 * new  # it is the bound that holds it there
    assert live.latest("contact") < pressed - 0.6 * (old - new)
    live.shoot("tune")


def test_an_impossible_value_is_refused_with_the_reason(live: Live) -> None:
    live.open_tab("Tune")
    old = live.page.config
    box = live.tab.locator("label", has_text="force max").first.locator("xpath=following::input[@type='text'][1]")
    box.fill("1")
    box.press("Enter")
    live.tab.get_by_text("Refused:").first.wait_for()
    assert "force" in live.tab.get_by_text("Refused:").first.inner_text()
    assert live.page.config == old
    until(lambda: float(box.input_value()) == bound(live), "the old value in the control")


def test_a_push_shows_in_the_plots(live: Live) -> None:
    live.open_tab("Touch")
    live.tab.get_by_role("button", name="Back to the task's target").click()
    until(lambda: live.latest("contact") == 0.0, "no contact")
    live.settle(2.0)
    calm = float(np.abs(live.column("error.z")[-25:]).max())
    drag(live, "force [N]", 0.5)
    live.tab.get_by_role("button", name="Push", exact=True).click()
    until(lambda: np.any(live.column("push.x") > 60.0), "a push")
    live.settle(1.0)
    live.shoot("push")
    pushed = live.column("push.x") > 60.0
    assert 0.25 <= 0.02 * np.count_nonzero(pushed) <= 0.35  # s, as the control says
    assert float(np.abs(live.column("error.x")[pushed]).max()) > calm + 1.0  # mm


def test_pause_step_and_slow_motion(live: Live) -> None:
    live.open_tab("Run")
    live.tab.get_by_role("button", name="Pause").click()
    live.tab.get_by_text("paused").wait_for()
    time.sleep(0.3)
    ticks = live.page.run.ticks
    live.tab.get_by_role("button", name="Step one period").click()
    until(lambda: live.page.run.ticks == ticks + 1, "one period")
    time.sleep(0.3)
    assert live.page.run.ticks == ticks + 1
    live.tab.get_by_role("button", name="Play").click()
    live.settle(0.05)


def test_recording_and_replay(live: Live) -> None:
    """What was recorded from the page is what the page shows."""
    live.open_tab("Run")
    live.tab.get_by_role("button", name="Record").click()
    live.tab.get_by_role("button", name="Stop recording").wait_for()
    live.settle(1.0)
    live.tab.get_by_role("button", name="Stop recording").click()
    until(lambda: live.page.run.recording is None, "the end of the log")
    [path] = list(live.folder.glob("*.mcap"))
    log = Log.open(path)
    assert not log.truncated
    assert log.failure is None
    shown = LoggedScene(log)
    middle = log.time()[len(log.time()) // 2]
    picture = shown.picture(float(middle))
    index = int(np.searchsorted(log.time("truth/flange/position"), middle))
    np.testing.assert_allclose(picture.tool, log["truth/flange/position"][index], atol=1e-9)
    columns, rows = shown.columns, shown.rows
    error = 1e3 * (log["reference/flange/position"] - log["truth/flange/position"])
    first = columns.names.index("error.x")
    np.testing.assert_allclose(rows[:, first : first + 3], error, atol=1e-9)


def test_a_log_on_the_page_with_a_time_slider(live: Live) -> None:
    """The slider, dragged in the browser, says which instant of the log is drawn."""
    shown = LoggedScene(Log.open(sorted(live.folder.glob("*.mcap"))[0]))
    with PageServer("127.0.0.1", 0) as server:
        replay = ReplayPage(server, shown)
        thread = threading.Thread(target=replay.serve, daemon=True)
        thread.start()
        live.tab.goto(server.url)  # the page of the loop lives on without a browser
        try:
            live.tab.get_by_role("button", name="Pause").click()
            live.tab.get_by_role("button", name="Play", exact=True).wait_for()
            drag(live, "time", 0.5)
            middle = 0.5 * (shown.time[0] + shown.time[-1])
            until(lambda: abs(replay.time - middle) < 0.1 * (shown.time[-1] - shown.time[0]), "the middle of the log")
            until(lambda: live.tab.get_by_text(f"t = {replay.time:.3f} s").is_visible(), "its time on the page")
            live.shoot("replay")
        finally:
            replay.stop()
            thread.join(PATIENCE)
            live.tab.goto(live.server.url)
    live.tab.get_by_text("playing").wait_for()


def test_a_second_browser_watches_takes_over_and_vanishes(live: Live) -> None:
    """Watching changes nothing; steering works once taken over; a tab that is closed in the middle of a recording
    leaves run and log whole.

    Events, not the mouse: it waits for a picture that stands still, while one processor draws two pages.
    """
    before = set(live.folder.glob("*.mcap"))
    other = new_tab(live.tab.context.browser, 820, 600)  # type: ignore[arg-type]
    other.goto(live.server.url)
    until(lambda: live.page.steering.watchers() == 1, "somebody who watches")
    other.get_by_role("button", name="Pause").dispatch_event("click")
    other.get_by_text("You are watching").first.wait_for()
    live.settle(0.2)
    other.get_by_role("button", name="Steer from this browser").dispatch_event("click")
    now = live.time
    other.get_by_role("button", name="Reset").dispatch_event("click")  # a log ends where a run begins again
    until(lambda: live.time < now, "the new run")
    other.get_by_role("button", name="Record").dispatch_event("click")
    other.get_by_role("button", name="Stop recording").wait_for()
    other.close()
    until(lambda: live.page.steering.watchers() == 0, "the browser's end")
    live.settle(0.5)
    live.tab.get_by_role("button", name="Stop recording").click()
    until(lambda: live.page.run.recording is None, "the end of the log")
    [path] = set(live.folder.glob("*.mcap")) - before
    log = Log.open(path)
    assert not log.truncated
    np.testing.assert_allclose(np.diff(log.time()), 1e-3, atol=1e-9)
    assert log.duration > 0.5


def test_nothing_went_wrong_in_the_console(live: Live) -> None:
    assert live.complaints == []
