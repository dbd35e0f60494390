"""What the command line says of input that it cannot use: one sentence and exit code 2."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

BAD_INPUT = [
    (["run", "stakc"], "no study or task named 'stakc'"),
    (["run", "--case", "figure9"], "no case 'figure9'"),
    (["run", "--controller", "pid"], "there is no controller 'pid'"),
    (["run", "--robot", "missing.urdf"], "missing.urdf does not exist"),
    (["run", "--robot", "broken.urdf"], "is not XML"),
    (["run", "--robot", "leg3"], "has no frame"),
    (["run", "press", "--robot", "leg3"], 'moves = "foot"'),
    (["run", "press", "--robot", "leg3", "--set", "tool.parent=foot"], 'moves = "foot"'),
    (["run", "wipe", "--set", "control.haptic.impedance.motion_damping=inf"], "haptic.impedance.motion_damping: "),
    (["run", "--set", "duration"], "key=value"),
    (["run", "--set", "duration=-1"], "must be above 0"),
    (["run", "--set", "duration=nan"], "finite number"),
    (["run", "--set", "lenght=2"], "unknown key 'lenght'"),
    (["run", "--set", "period=0.0007"], "whole multiple"),
    (["run", "--set", "control.tasks.ee.translation.range=0.001"], "range x_b must exceed linear_range x_0"),
    (["run", "--set", "control.tasks.ee.translation.force_max=1"], "force_max must be at least"),
    (["run", "--set", "control.tasks.ee.frame=nose"], "has no frame 'nose'"),
    (["run", "--set", "control.tasks.ee.frame=universe"], "has no frame 'universe'"),
    (["run", "polishing", "--set", "pushes.frame=universe"], "has no frame 'universe'"),
    (["run", "polishing", "--set", "physics_step=1e-7", "--set", "duration=4"], "within a factor of 1000"),
    (["run", "polishing", "--set", "estimation.tare=odd"], "tare"),
    (["doctor", "iiwa14", "--locked", "A9=0"], "no joint 'A9' to lock"),
    (["doctor", "iiwa14", "--locked", "A7"], "JOINT=ANGLE"),
    (["doctor", "iiwa14", "--locked", "A7=nan"], "finite"),
    (["doctor", "--locked", "A7=0"], "--locked needs a robot"),
    (["run", "--out", "broken.urdf/x"], "output folder"),
    (["run", "missing.toml"], "missing.toml does not exist"),
    (["run", "twice.toml"], "is not TOML"),
    (["run", "nostudy.toml"], "unknown key 'duration'"),
    (["run", "unknown.toml"], "unknown key 'speed'"),
    (["study", "nothing"], "no study or task named 'nothing'"),
    (["log", "missing.mcap"], "missing.mcap cannot be read"),
    (["log", "broken.urdf"], "broken.urdf"),
    (["bench", "nothing"], "no benchmark 'nothing'"),
    (["list", "nothing"], "no list of 'nothing'"),
    (["fly"], "No such command"),
    (["run", "--seed", "one"], "--seed"),
]


@pytest.mark.parametrize(("arguments", "words"), BAD_INPUT, ids=[" ".join(a) for a, _ in BAD_INPUT])
def test_bad_input_gets_one_sentence_and_exit_code_2(
    arguments: list[str],
    words: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    (tmp_path / "broken.urdf").write_text("<robot")
    (tmp_path / "twice.toml").write_text('study = "stack"\nduration = 1\nduration = 2\n')
    (tmp_path / "nostudy.toml").write_text("duration = 1\n")
    (tmp_path / "unknown.toml").write_text('study = "stack"\nspeed = 1\n')
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "argv", ["pliant", *arguments])
    from pliant.cli import main

    with pytest.raises(SystemExit) as ended:
        main()
    captured = capsys.readouterr()
    assert ended.value.code == 2
    assert words in captured.err
    assert "Traceback" not in captured.err
