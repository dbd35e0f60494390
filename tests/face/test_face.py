"""What `import pliant` offers: cheap, complete, typed, and as the documentation shows it."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

import pliant
from pliant.errors import ConfigError

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs" / "python.md").read_text()


def blocks(text: str) -> list[str]:
    return re.findall(r"```python\n(.*?)```", text, re.DOTALL)


def heavy_of(statement: str) -> str:
    code = f"import sys; {statement}; heavy = ('numpy', 'pinocchio', 'mujoco', 'pydantic')"
    code += "; print([name for name in heavy if name in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=120)
    return done.stdout.strip()


@pytest.mark.parametrize("name", ["pliant", "pliant.mpc"])
def test_importing_it_loads_nothing_heavy(name: str) -> None:
    assert heavy_of(f"import {name}") == "[]"


def test_the_first_use_of_a_name_loads_what_it_needs() -> None:
    assert heavy_of("from pliant.mpc import MpcConfig") == "['numpy', 'pinocchio', 'pydantic']"


def test_every_name_resolves_and_is_told_to_type_checkers() -> None:
    tree = ast.parse((Path(pliant.__file__).parent / "__init__.pyi").read_text())
    typed = {
        alias.asname or ""
        for node in tree.body
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
        if alias.asname
    }
    typed |= {"__version__", "controllers", "errors", "robots"}  # the last three are packages and a module
    assert typed == set(pliant.__all__)
    for name in pliant.__all__:
        assert getattr(pliant, name) is not None
    with pytest.raises(AttributeError, match="no attribute 'rnu'"):
        _ = pliant.rnu  # type: ignore[attr-defined]


def test_every_name_has_an_example() -> None:
    used = set(re.findall(r"pliant\.(\w+)", "\n".join(blocks(PAGE))))
    assert set(pliant.__all__) - {"__version__"} <= used


def test_the_examples_run(capsys: pytest.CaptureFixture[str]) -> None:
    scope: dict[str, object] = {}
    for block in blocks(PAGE):
        exec(compile(block, "docs/python.md", "exec"), scope)
    said = capsys.readouterr().out
    assert "hold, rms" in said
    assert "did you mean 'haptic'" in said
    assert "did you mean 'iiwa14'" in said


def test_the_example_of_the_readme_moves_a_robot(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (block, *_) = blocks((ROOT / "README.md").read_text())
    lines = [line for line in block.splitlines() if line.strip()]
    assert len(lines) <= 5
    monkeypatch.chdir(tmp_path)
    scope: dict[str, Any] = {}
    exec(compile(block, "README.md", "exec"), scope)
    q = scope["result"].log["measurement/q"]
    assert abs(q[-1] - q[0]).max() > 0.1  # rad
    assert not list(tmp_path.iterdir())  # nothing is written unless a folder is given


def test_a_task_is_run_by_its_name_or_its_file(tmp_path: Path) -> None:
    (tmp_path / "mine.toml").write_text('base = "wipe"\n', encoding="utf-8")
    for what in ("wipe", tmp_path / "mine.toml"):
        with pytest.raises(ConfigError, match=r"unknown key 'path\.sped'.*did you mean 'speed'"):
            pliant.run(what, **{"path.sped": 1.0})


@pytest.mark.parametrize("package", ["pandas", "polars"])
def test_a_log_as_a_data_frame(package: str) -> None:
    from pliant.telemetry.columns import columns

    result = pliant.run("haptic", duration=0.01, steps=[{"target": (0.0, 0.0, 0.25)}], checks=[])
    found = columns(result.log, ("command/torque", "measurement/q"))
    labels = result.log.channels["command/torque"].labels
    assert list(found)[:2] == ["time", f"command/torque.{labels[0]}"]
    assert found[f"command/torque.{labels[2]}"] == pytest.approx(result.log["command/torque"][:, 2])
    pytest.importorskip(package)
    frame = result.log.to_pandas() if package == "pandas" else result.log.to_polars()
    assert frame["time"][3] == pytest.approx(0.003)


def test_a_comparison_takes_one_seed_and_no_fewer() -> None:
    found = pliant.compare("haptic", ["haptic", "haptic-hold"], seeds=1, duration=0.05, checks=[])
    assert [run.config.seed for run in found.runs] == [0, 0]
    with pytest.raises(ConfigError, match="needs a controller and a seed, got 1 and 0"):
        pliant.compare("haptic", ["haptic"], seeds=0)
    with pytest.raises(ConfigError, match="got 0 and 3"):
        pliant.compare("haptic", [], seeds=3)


@pytest.mark.parametrize("key", ["variant", "study"])
def test_what_says_which_run_it_is_cannot_be_changed(key: str) -> None:
    with pytest.raises(ConfigError, match=f"{key!r} says which run it is"):
        pliant.run("haptic", **{key: "another"})
