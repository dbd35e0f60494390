"""`pliant live` in a process of its own: bad input gets one sentence and exit code 2."""

from __future__ import annotations

import importlib.util
import multiprocessing
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
import viser
import zstandard
from typer.testing import CliRunner
from websockets.sync.client import ClientConnection, connect
from websockets.typing import Origin, Subprotocol

from pliant.cli.app import app
from pliant.configuration import merged
from pliant.experiments.registry import get_study
from pliant.experiments.runner import run_case
from pliant.live.page.logged_scene import LoggedScene
from pliant.live.page.replay import ReplayPage
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
    assert "no study or task named 'stak'" in said
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
        assert "the file is truncated" in page.header


def test_a_page_beside_a_run_ends_with_it(tmp_path: Path) -> None:
    """`pliant run --live` writes what it writes without a page."""
    settings = ["--no-figures", "--set", "path.kind=hold", "--set", "path.ramp=0.0", "--set", "duration=1.5"]
    done = pliant("run", "stack", "--case", "figure8-plain", "--live", "--out", str(tmp_path), *settings)
    assert done.returncode == 0, done.stderr
    assert "open  http://127.0.0.1:" in done.stdout
    [path] = tmp_path.glob("*.mcap")
    log = Log.open(path)
    assert log.failure is None
    assert len(log.time()) == 1500
    assert (tmp_path / "summary.json").exists()


def frames(page: ClientConnection) -> Iterator[bytes]:
    """What the page's server sends, unpacked: sizes, then a zstd stream."""
    unpack = zstandard.ZstdDecompressor().decompressobj
    while True:
        frame = page.recv(timeout=180)
        assert isinstance(frame, bytes)
        yield unpack().decompress(frame[16:])


def stretch() -> float:
    """How many times longer than alone on the machine a piece of work takes now; at least 1."""
    start, worked = time.monotonic(), time.thread_time()
    while time.thread_time() - worked < 0.1:
        pass
    return max((time.monotonic() - start) / 0.1, 1.0)


def kill_and_watch(server: PageServer, waits: list[float]) -> None:
    """Opens the page, kills its loop, and notes how long the page took to say so: s of a machine without other work."""
    origin, _, token = server.url.partition("/?token=")
    with connect(
        f"ws://127.0.0.1:{server.port}/",
        additional_headers={"Cookie": f"pliant-token-{server.port}={token}"},
        origin=Origin(origin),
        subprotocols=[Subprotocol(f"viser-v{viser.__version__}")],
        max_size=None,
    ) as page:
        next(frames(page))
        end = time.monotonic() + 60.0
        while not (loops := [child for child in multiprocessing.active_children() if child.name == "pliant-loop"]):
            assert time.monotonic() < end, "no loop"
            time.sleep(0.02)
        [loop] = loops
        before = stretch()
        loop.kill()
        killed = time.monotonic()
        next(text for text in frames(page) if b"loop has ended unexpectedly" in text)
        took = time.monotonic() - killed
        waits.append(took / max(before, stretch()))


def test_a_loop_that_is_killed_is_said_by_the_page_and_ends_the_command(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    waits: list[float] = []

    def start(server: PageServer) -> PageServer:
        threading.Thread(target=kill_and_watch, args=(server, waits), daemon=True).start()
        return entered(server)

    entered = PageServer.__enter__
    monkeypatch.setattr(PageServer, "__enter__", start)
    done = CliRunner().invoke(app, ["live", "stack", "--port", "0", "--out", str(tmp_path)])
    assert done.exit_code == 1, done.output
    said = "failed: the process of the loop has ended unexpectedly; start the command again"
    assert done.stderr.splitlines() == [said]
    [told] = waits
    assert told < 2.0
