"""Files that cannot be run: one sentence with the key and the remedy, exit code 2, no traceback."""

from __future__ import annotations

from pathlib import Path

import pytest
from typer.testing import CliRunner

from pliant.cli.app import app

CLI = CliRunner()
FILE = '[path]\npattern = "file"\nfile = "path.csv"\n'
LIST = 'robot = "leg3"\ncontroller = "haptic"\nmoves = "foot"\n'
BALL = '[surface]\nshape = "sphere"\nradius = 0.05\npose = { xyz = [0.5, 0.0, 0.1] }\n'
BOX = '[scene.box]\nshape = "box"\n'
PHASE = '[[phase]]\nname = "one"\ntarget = [0.1, 0.0, 0.1]\nduration = 0.5\n'


@pytest.mark.parametrize(
    ("text", "csv", "sentence"),
    [
        ('[path]\npattern = "zigzag"\n', "", "path.pattern"),
        ("[path]\nspede = 0.1\n", "", "did you mean 'speed'"),
        ("[pathh]\nspeed = 0.1\n", "", "did you mean 'path'"),
        (FILE, "x,y,z\n0,0,0\n0.05,0,0\n0.1,0,0.08\n", "line 4: the point is 80.0 mm off the believed surface"),
        (FILE, "x,y\n0,0\n60,0\n60,40\n", "is it in millimetres? then set path.unit = 'mm'"),
        (FILE, "x,y\n0,0\n0.1,far\n", "line 3: column 'y' must be a finite number, got 'far'"),
        (
            "[surface]\npose = { xyz = [2.0, 0.0, 0.0] }\n",
            "",
            "short; move it by surface.pose or path.at: `pliant task check`",
        ),
        (FILE, "x,y\n0,0\n0.05,0\n1.2,0\n", "short, on the way to line 4 of path.csv; move it by"),
        ("[force]\nnormal = 50\n[limits]\nforce = 40\n", "", "force.normal asks for 50 N, and limits.force allows 40"),
        (
            FILE + "[limits]\nforce = 8\n",
            "x,y,force\n0,0,5\n0.05,0,9\n",
            "path.csv, line 3, column 'force' asks for 9 N, and limits.force allows 8",
        ),
        (
            FILE + "[limits]\nspeed = 0.1\n",
            "x,y,speed\n0,0,0.05\n0.05,0,0.2\n",
            "path.csv, line 3, column 'speed' asks for 0.2 m/s, and limits.speed allows 0.1",
        ),
        (
            FILE + "[limits]\nspeed = 0.1\n",
            "x,y,time\n0,0,0\n0.05,0,1\n0.1,0,1.1\n",
            "path.csv, line 4, column 'time' asks for 0.5 m/s, and limits.speed allows 0.1",
        ),
        (FILE, "x,y,force\n0,0,5\n0.05,0,-5\n", "path.csv, line 3: column 'force' must not be negative, got -5"),
        (FILE, "x,y,speed\n0,0,-0.1\n0.05,0,0.1\n", "path.csv, line 2: column 'speed' must not be negative, got -0.1"),
        (FILE, "x,y\n0,0\n0,0\n", "path.csv, lines 2 to 3: all points are the same"),
        ('[path]\npattern = "line"\nsize = [0.0, 0.0]\n', "", "path.size = [0, 0] is no line"),
        (FILE + BALL, "x,y\n0,0\n0.05,0\n0.2,0\n", "path.csv, line 4: the path runs round the surface"),
        (FILE + BALL, "x,y\n0,0\n0.31,0\n", "path.csv, line 3: the path runs round the surface"),
        (LIST + BOX + BOX + PHASE, "", "scene"),
        (LIST + PHASE + PHASE, "", "phases need different names"),
        (FILE, "x,y,x\n0,0,0\n", "column 'x' stands there twice"),
        (
            "[path]\nspeed = 0.1\nspeed = 0.2",
            "",
            "line 3: key 'path.speed' stands there twice, the first time in line 2",
        ),
        ("[force]\nnormal = true\n", "", "force.normal: must be given in numbers, not as true or false"),
    ],
)
def test_a_task_that_cannot_be_is_one_sentence(
    text: str, csv: str, sentence: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("task.toml").write_text(text, encoding="utf-8")
    Path("path.csv").write_text(csv, encoding="utf-8")
    done = CLI.invoke(app, ["run", "task.toml"])
    said = " ".join(done.output.split())
    assert done.exit_code == 2, said
    assert sentence in said
    assert "Traceback" not in said
    assert len(said.split(". ")) <= 2, said
    checked = CLI.invoke(app, ["task", "check", "task.toml"])
    assert checked.exit_code != 0, "the check calls possible what a run refuses"


@pytest.mark.parametrize("name", ["task.toml", "path.csv"])
def test_what_is_no_utf_8_is_one_sentence(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("task.toml").write_text(FILE, encoding="utf-8")
    Path("path.csv").write_text("x,y\n0,0\n0.1,0\n", encoding="utf-8")
    Path(name).write_bytes(Path(name).read_bytes() + b"# \xe9\xff\n")
    done = CLI.invoke(app, ["run", "task.toml"])
    said = " ".join(done.output.split())
    assert done.exit_code == 2, said
    assert name in said
    assert "UTF-8" in said
