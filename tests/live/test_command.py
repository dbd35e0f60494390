"""`pliant live` in a process of its own: bad input gets one sentence and exit code 2."""

from __future__ import annotations

import importlib.util
import multiprocessing
import socket
import subprocess
import sys
import time
from pathlib import Path

import pytest
from typer.testing import CliRunner

from pliant.cli.app import app
from pliant.errors import RunFailedError
from pliant.experiments.config import merged
from pliant.experiments.registry import get_study
from pliant.experiments.runner import run_case
from pliant.live.page.page import Page
from pliant.live.page.replay import LoggedScene, ReplayPage
from pliant.live.server.launch import serve_live
from pliant.live.server.web import PageServer
from pliant.telemetry.log import Log


def pliant(*arguments: str) -> subprocess.CompletedProcess[str]:
    program = "from pliant.cli import main; main()"
    call = [sys.executable, "-c", program, *arguments]
    return subprocess.run(call, capture_output=True, text=True, check=False, timeout=200)


def refused(*arguments: str) -> str:
    """The one sentence on standard error with which `pliant live` ends, with exit code 2."""
    done = CliRunner().invoke(app, ["live", *arguments])
    assert done.exit_code == 2, done.output
    lines = done.stderr.strip().splitlines()
    assert len(lines) == 1, done.stderr
    assert lines[0].startswith("error: ")
    return lines[0]


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A log of 1.5 s."""
    folder = tmp_path_factory.mktemp("log")
    study = get_study("stack")
    config = merged(study.case("figure8-plain"), {"path": {"kind": "hold", "ramp": 0.0}, "duration": 1.5})
    run_case(study, config, folder, figures=False)
    [path] = folder.glob("*.mcap")
    return path


def test_port_in_use() -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        said = refused("stack", "--port", str(port))
        assert f"port {port} on 127.0.0.1 is in use" in said
        assert "--port" in said


def test_unknown_study_and_case() -> None:
    said = refused("stak")
    assert "no study named 'stak'" in said
    assert "did you mean 'stack'?" in said
    assert "no case 'figure9'" in refused("stack", "--case", "figure9")


def test_no_such_log_and_no_log(tmp_path: Path) -> None:
    assert "none.mcap cannot be read" in refused(str(tmp_path / "none.mcap"))
    (tmp_path / "text.mcap").write_text("this is not a log")
    assert "text.mcap" in refused(str(tmp_path / "text.mcap"))


def test_a_log_cut_off_at_its_head(log: Path, tmp_path: Path) -> None:
    stump = tmp_path / "stump.mcap"
    stump.write_bytes(log.read_bytes()[:64])
    assert "cut off" in refused(str(stump))


def test_without_viser_the_sentence_names_the_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    find = importlib.util.find_spec
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None if name == "viser" else find(name))
    assert "pip install 'pliant[live]'" in refused("stack")


def test_a_log_cut_off_in_the_middle_is_shown_up_to_there(log: Path, tmp_path: Path) -> None:
    stump = tmp_path / "half.mcap"
    raw = log.read_bytes()
    stump.write_bytes(raw[: len(raw) * 6 // 10])
    whole, half = Log.open(log), Log.open(stump)
    assert half.truncated
    shown = LoggedScene(half)
    assert 0.0 < shown.time[-1] < whole.time()[-1]
    with PageServer("127.0.0.1", 0) as server:
        page = ReplayPage(server, shown)
        assert "cut off" in page.header


def test_a_page_beside_a_run_ends_with_it(tmp_path: Path) -> None:
    """`pliant run --live` writes what it writes without a page."""
    settings = ["--set", "path.kind=hold", "--set", "path.ramp=0.0", "--set", "duration=1.5"]
    done = pliant("run", "stack", "--case", "figure8-plain", "--live", "--out", str(tmp_path), *settings)
    assert done.returncode == 0, done.stderr
    assert "open  http://127.0.0.1:" in done.stdout
    [path] = tmp_path.glob("*.mcap")
    log = Log.open(path)
    assert log.failure is None
    assert len(log.time()) == 1500
    assert (tmp_path / "summary.json").exists()


def test_a_loop_that_is_killed_ends_the_command_with_a_sentence(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    said: list[tuple[str, float]] = []
    killed: list[float] = []

    def kill(server: PageServer) -> None:
        [loop] = [child for child in multiprocessing.active_children() if child.name == "pliant-loop"]
        loop.kill()
        loop.join()
        killed.append(time.monotonic())

    monkeypatch.setattr(Page, "mourn", lambda page, text: said.append((text, time.monotonic())))
    study = get_study("stack")
    with pytest.raises(RunFailedError, match="the process of the loop has ended unexpectedly"):
        serve_live("stack", study.case("figure8-plain"), "127.0.0.1", 0, tmp_path, kill)
    [(text, at)] = said
    assert "loop has ended" in text
    assert at - killed[0] < 2.0
