"""A controller from a file of one's own on the page: while it runs, in its log, and when the log is shown again."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from pliant.live.page.replay import LoggedScene, ReplayPage
from pliant.live.server.web import PageServer
from pliant.telemetry.log import Log
from tests.wiring.test_plugins import MINE, pliant

pytestmark = pytest.mark.study


def test_it_runs_under_the_page_and_its_log_is_shown_again(tmp_path: Path) -> None:
    (tmp_path / "mine.py").write_text(MINE)
    done = pliant(
        "run", "haptic", "--live", "--controller", "mine.py:Spring", "--set", "duration=0.3",
        "--set", "steps=[{target = [0, 0, 0.25]}]", "--set", "checks=[]", "--out", "out", cwd=tmp_path,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert "http://127.0.0.1" in done.stdout + done.stderr
    (case,) = json.loads((tmp_path / "out" / "summary.json").read_text())["cases"]
    assert case["controller"] == "mine.py:Spring"
    (path,) = (tmp_path / "out").glob("*.mcap")
    log = Log.open(path)
    assert log["spring/force"].shape == (300, 3)
    assert log.channels["spring/force"].unit == "N"
    shown = LoggedScene(log)
    with PageServer("127.0.0.1", 0) as server:
        page = ReplayPage(server, shown)  # the file of the controller is not beside this process
        assert "mine.py:Spring" in page.header
    assert shown.time[-1] == pytest.approx(0.299, abs=2e-3)
