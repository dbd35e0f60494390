"""Lists of phases that cannot be run, or contradict themselves, are refused in one sentence."""

from __future__ import annotations

from pathlib import Path

import pytest

from pliant.errors import ConfigError
from pliant.studies.task.study import study_of
from tests.tasks.lists import FIRST, PHASES, case_from

INSERTION = """
robot = "panda"
controller = "haptic"
scene.hole = { shape = "plane", pose = { xyz = [0.5, 0.0, 0.2] } }
[[phase]]
frame = "hole"
target = [0.0, 0.0, -0.01]
modes = ["motion", "motion", "force", "force", "force", "motion"]
wrench = [0, 0, 8, 0, 0, 0]
until = { any = [{ depth = 0.004 }, { timeout = 8.0 }] }
else = "fail"
"""


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (INSERTION.replace('modes = ["motion", "motion", "force"', 'modes = ["motion", "motion", "motion"').replace(
            '"force", "force", "motion"]', '"motion", "motion", "motion"]'), r"axes whose mode is not force: z"),
        (INSERTION + 'motion = { shape = "stop" }\n', r"'stop' is for a timed list"),
        (INSERTION.replace('frame = "hole"', 'frame = "hull"'), r"a thing of the scene or a pose; valid: 'hole'"),
        (PHASES + FIRST + 'touch = "flor"\nduration = 1.0\n', r"touch names no thing.*did you mean 'floor'"),
        (PHASES + FIRST + "until = { force = 3.0 }\n", r"'down' may never end"),
        (PHASES + '[[phase]]\nduration = 1.0\n', r"the first phase needs a target"),
        (PHASES + FIRST + "duration = 1.0\n[[event]]\nchange = { tarjet = [0, 0, 0] }\n", r"did you mean 'target'"),
        (PHASES + FIRST + "duration = 1.0\n[[event]]\nchange = { target = [0, 0] }\n", r"target is 3 numbers, got"),
        (PHASES + FIRST + 'duration = 1.0\n[[event]]\nchange = { reset = "no" }\n', r"true or false, got 'no'"),
        (
            PHASES + FIRST + "duration = 1.0\n[[event]]\nchange = { wrench = [0, 0, { unifrm = [1, 2] }] }\n",
            r"event 1: a value is drawn as { uniform = … }",
        ),
        (
            PHASES + FIRST + "duration = 1.0\n[[event]]\nevery = 1e-9\nchange = { force_max = 9.0 }\n",
            r"at most 100000 changes, got 1000000000",
        ),
        (
            PHASES.replace('"haptic"', '"operational-space"').replace("impedance =", "planner = {} #")
            + FIRST
            + "duration = 1.0\n[[event]]\nfactor = { stiffness = 2.0 }\n",
            r"event 1: factor scales impedances, and this controller has none",
        ),
        (
            PHASES + FIRST + 'duration = 1.0\n[[phase]]\nduration = 1.0\ntracks.foot = { shape = "hold" }\n',
            r"a phase with tracks is the only one",
        ),
        (
            'robot = "panda"\ncontroller = "stack"\n[[phase]]\nduration = 1.0\ntracks.flange = { shape = "hold" }\n'
            'tracks.elbow = { shape = "hold" }\n',
            r"the first frame has a motion, and the others are 'posture'",
        ),
    ],
)  # fmt: skip
def test_what_cannot_be_run_is_refused_in_a_sentence(tmp_path: Path, text: str, message: str) -> None:
    case = case_from(tmp_path, text)  # the file itself is in order
    with pytest.raises(ConfigError, match=message) as caught:
        study_of(str(tmp_path / "task.toml")).build(case)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (PHASES + FIRST, r"either duration or until"),
        (PHASES + FIRST + "duration = 1.0\nuntil = { contact = true }\n", r"either duration or until"),
        (PHASES + FIRST + "until = { contact = true, timeout = 2.0 }\n", r"a timeout stands alone"),
        (PHASES + FIRST + "until = {}\n", r"a condition needs one of"),
        (PHASES + FIRST.replace("[0, 0, 20]", "[0, 20]") + "duration = 1.0\n", r"three or six axes, got 2"),
        (PHASES + FIRST + "duration = 1.0\n" + FIRST + "duration = 1.0\n", r"phases need different names"),
        (PHASES + FIRST + "duration = 1.0\n[[event]]\ncount = 3\n", r"\(count\) needs the time between them"),
        (PHASES + FIRST + 'duration = 1.0\n[[event]]\nfile = "a.csv"\nevery = 1.0\n', r"an event of a file has no"),
        (PHASES, r"belongs to a task of \[\[phase\]\]"),
        (PHASES + "path.speed = 0.1\n" + FIRST + "duration = 1.0\n", r"path belongs to a task with a path"),
        (PHASES + "truth.tilt = 3.0\n" + FIRST + "duration = 1.0\n", r"truth\.tilt belongs to a task with a path"),
        (PHASES.replace('"plane"', '"plane", mass = 1.0') + FIRST + "duration = 1.0\n", r"a plane cannot move"),
    ],
)
def test_a_file_that_contradicts_itself_is_refused(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        case_from(tmp_path, text)
