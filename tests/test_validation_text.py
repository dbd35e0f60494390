"""What is wrong with a configuration: the key as it stands in the file, and the rule; nothing of Python or pydantic."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator, Mapping
from typing import Any, cast

import pytest
from pydantic import BaseModel

from pliant.configuration import merged, parse_assignments, refuse_unknown_keys, validated
from pliant.errors import ConfigError
from pliant.overlay import models_in
from pliant.tasks.task import Task

INTERNAL = re.compile(
    r"function-|literal\[|tuple|dict|Input should|instance of|[Ff]ield required|NoneType|Model|<class|pydantic"
)
"""words of Python and pydantic"""
WRONG: tuple[Any, ...] = ([], {}, "odd", -3, True, [1], ["odd"], {"odd": 1}, [{"odd": 1}], None, [[[2]]], {"odd": {}})
LIST = 'robot = "leg3"\nmoves = "foot"\n[[phase]]\nname = "down"\ntarget = [0.1, 0.0, 0.1]\n'
DOWN = LIST + "wrench = [0, 0, 15]\nduration = 1\n"


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        (LIST + "until = { contakt = true }", "unknown key 'phase.down.until.contakt'; valid: 'any', 'contact', "),
        (LIST + "until = { any = [] }", "phase.down.until.any: must have at least 1 entry, got []"),
        (LIST + "until = 3", "phase.down.until: must be a table with duration, contact, force, "),
        (LIST.replace('name = "down"\n', "") + "duration = -1", "phase.1.duration: must be above 0, got -1"),
        (DOWN + 'modes = ["motion", "motion", "frce"]', "phase.down.modes.3: must be 'motion', 'force' or 'free' (did"),
        (DOWN.replace("0, 0, 15", "0, 15"), "phase.down: a wrench has three or six axes, got 2"),
        (DOWN + DOWN.partition('foot"\n')[2], "phases need different names, got ['down', 'down']"),
        ("[surface]\nshape = 'plane'\nstiffness = 3e3\n" + DOWN.partition('foot"\n')[2], "surface belongs to a task"),
        ("[truth]\nshift = { gauss = [0, 1] }", "unknown key 'truth.shift.gauss'; valid: 'choice', 'log_uniform', "),
        ("[truth]\nshift = { uniform = [4, -4] }", "truth.shift.uniform: a range goes from low to high, [lowest"),
        ("[truth]\nshift = 'far'", "truth.shift: must be a number or a table with uniform, log_uniform, "),
        ("[truth]\nimperfections = 'p9'", "truth.imperfections: must be 'none', 'p3' or 'p3-without-torque-loop' or a"),
        ("[force]\nnormal = 'hard'", "force.normal: must be a number or a list, got 'hard'"),
        ("[force]\nnormal = [[0, 5], ['late', 5]]", "force.normal.2.1: must be a number, got 'late'"),
        ("[path]\nsize = [1, 2, 3]", "path.size: must have at most 2 entries, got [1, 2, 3]"),
        ("[surface]\npose = { xyz = [0.4, 0.0] }", "surface.pose.xyz: entry 3 is missing, got [0.4, 0.0]"),
        ("format = 99\nfuture = 1", "written for a newer pliant (format 99), this one reads up to 1: update pliant"),
    ],
)
def test_each_is_one_plain_sentence(text: str, sentence: str) -> None:
    with pytest.raises(ConfigError) as refused:
        validated(Task, tomllib.loads(text))
    said = str(refused.value)
    assert sentence in said
    assert not INTERNAL.search(said), said
    assert len(said) < 400


def _with_each_wrong(kind: type[BaseModel]) -> Iterator[dict[str, Any]]:
    """Every field of a configuration, and of those in it, with each wrong value."""
    for name, field in kind.model_fields.items():
        yield from ({field.alias or name: wrong} for wrong in WRONG)
        for below in models_in(field.annotation):
            for values in _with_each_wrong(below):
                yield {name: values}
                yield {name: [values]}
                yield {name: {"one": values}}


def test_no_wrong_value_of_any_field_shows_python() -> None:
    said = [_said(values) for values in _with_each_wrong(Task)]
    told = [text for text in said if text]
    assert len(told) > 1000  # most of them are wrong
    assert [text for text in told if INTERNAL.search(_without_names(text))] == []


def _said(values: Mapping[str, Any]) -> str:
    try:
        validated(Task, values)
    except ConfigError as error:
        return str(error)
    return ""


def _without_names(text: str) -> str:
    """Without words of ours that hold one of the forbidden ones."""
    return text.replace("predict", "").replace("model_error", "")


def test_long_values_are_cut() -> None:
    with pytest.raises(ConfigError, match=r"path\.speed: must be a number, got 'x{59}…$"):
        validated(Task, {"path": {"speed": "x" * 500}})


def test_a_name_in_a_list_that_is_empty_is_refused() -> None:
    with pytest.raises(ConfigError, match=r"phase has nothing called 'x'; there is no \[\[phase\]\] at all"):
        merged(Task(), parse_assignments(["phase.x.duration=1"]))


def test_unknown_keys_alone_can_be_refused() -> None:
    odd: Mapping[str, Any] = {"path": {"speed": "fast", "sped": 1}}
    with pytest.raises(ConfigError, match=r"unknown key 'path\.sped'; .*did you mean 'speed'"):
        refuse_unknown_keys(Task, odd)
    refuse_unknown_keys(Task, cast("Mapping[str, Any]", {"path": {"speed": "fast"}}))
