"""Timed lists that say what they cannot, or contradict themselves, are refused in one sentence."""

from __future__ import annotations

from pathlib import Path

import pytest

from pliant.errors import ConfigError
from pliant.studies.task.study import study_of
from tests.tasks.lists import case_from
from tests.tasks.timed_lists import DOWN, PRESS, TIMED


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (TIMED + DOWN + PRESS + "limit = { speed = 0.1 }\n", r"'press': limit is not for a timed list"),
        (TIMED + DOWN.replace("duration = 0.5", "until = { force = 3.0, duration = 1.0 }"), r"by time or by contact"),
        (TIMED + DOWN + "[[event]]\nchange = { wrench = [0, 0, 1] }\n", r"a timed list has no events"),
        (TIMED.replace("timed = true", "") + DOWN + PRESS, r"frame is world, a thing of the scene or a pose"),
        (TIMED.replace("timed = true", "") + DOWN + "arrive = 0.2\n", r"'down': arrive is for a timed list"),
        (
            TIMED.replace("timed = true", "") + DOWN + "profile = { times = [0.0], wrench = [[0.0, 0.0, 5.0]] }\n",
            r"profile is for a timed list",
        ),
        (TIMED + DOWN + 'motion = { shape = "stop" }\n', r"no motion before it that could stop"),
        (
            TIMED + DOWN + 'motion = { shape = "circle", across = [1, 0, 0], up = [1, 1, 0] }\n',
            r"must be perpendicular",
        ),
        (
            TIMED
            + DOWN.replace(
                "duration = 0.5", 'until = { any = [{ contact = true }, { timeout = 1.0 }] }\nelse = "next"'
            ),
            r"contact that is not felt in time is a failure",
        ),
    ],
)
def test_what_a_list_cannot_say_is_refused(tmp_path: Path, text: str, message: str) -> None:
    case = case_from(tmp_path, text)
    with pytest.raises(ConfigError, match=message) as caught:
        study_of(str(tmp_path / "task.toml")).build(case)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            DOWN + "wrench = [0, 0, 1]\nprofile = { times = [0], wrench = [[0, 0, 1]] }\n",
            r"either a wrench or a profile",
        ),
        (DOWN + "profile = { times = [0, 1], wrench = [[0, 0, 1]] }\n", r"one wrench a time, got 2 and 1"),
        (DOWN + "profile = { times = [1, 0], wrench = [[0, 0, 1], [0, 0, 2]] }\n", r"times of a profile increase"),
        (DOWN + "profile = { times = [0], wrench = [[0, 1]] }\n", r"three or six axes, got 2"),
        (DOWN + 'motion = { shape = "stop", ramp = 0.0 }\n', r"cannot stop within 0 s"),
        (DOWN + 'motion = { shape = "zigzag" }\n', r"'lemniscate', 'line', 'circle'"),
        (DOWN + 'like = "dwn"\n', r"like: there is no phase 'dwn'; valid: 'down' .*did you mean 'down'"),
    ],
)
def test_a_file_that_contradicts_itself_is_refused(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        case_from(tmp_path, TIMED + text)
    with pytest.raises(ConfigError, match=r"timed belongs to a task of \[\[phase\]\]"):
        case_from(tmp_path, 'timed = true\n[path]\npattern = "line"\n')
