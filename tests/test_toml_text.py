"""A TOML file in which a key stands twice: key and both lines are named, whatever follows."""

from __future__ import annotations

from pathlib import Path

import pytest

from pliant.configuration import read_toml
from pliant.errors import ConfigError


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("[path]\nspeed = 0.1\nspeed = 0.2", "line 3: key 'path.speed' stands there twice, the first time in line 2"),
        ("a = 1\n\n# a = 2\na = [\n1,\n2]\nb = 1\n", "line 4: key 'a' stands there twice, the first time in line 1"),
        ("[a]\nb = 1\n[c]\nb = 1\n[a]\nd = 1\n", "line 5: key 'a' stands there twice, the first time in line 1"),
        ("path.speed = 1\npath.speed = 2\n", "line 2: key 'path.speed' stands there twice, the first time in line 1"),
        ("[a]\nb = 1\n[c]\nb = 2\nb = 3\n", "line 5: key 'c.b' stands there twice, the first time in line 4"),
        ("b = { c = 1, c = 2 }\n", "line 1: key 'b' stands there twice"),
        ("a.b = 1\n[a]\nc = 1\n", "line 2: key 'a' stands there twice"),
        ("a = 1\nb 2\n", "Expected '=' after a key in a key/value pair (at line 2"),
    ],
)
def test_a_key_that_stands_twice_is_named_with_its_lines(text: str, sentence: str, tmp_path: Path) -> None:
    file = tmp_path / "task.toml"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(ConfigError) as refused:
        read_toml(file)
    assert f"task.toml is not TOML: {sentence}" in str(refused.value)


def test_what_stands_once_is_read(tmp_path: Path) -> None:
    file = tmp_path / "task.toml"
    file.write_text("[a]\nb = 1\n[c]\nb = 2\n[[d]]\nb = 1\n[[d]]\nb = 2\n", encoding="utf-8")
    assert read_toml(file)["d"] == [{"b": 1}, {"b": 2}]
