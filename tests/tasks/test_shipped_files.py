"""Files of the catalogue are read once; others each time."""

import shutil
from pathlib import Path

from pliant.tasks import load_task
from pliant.tasks.files import CATALOGUE, read_task


def test_a_task_of_the_catalogue_is_read_once() -> None:
    assert load_task("wipe") is load_task("wipe")
    variant = next(iter(read_task("wipe").variants), None)
    assert variant is None or load_task("wipe", variant) is load_task("wipe", variant)
    assert load_task("wipe") == load_task(CATALOGUE / "wipe.toml")


def test_a_file_of_ones_own_is_read_again(tmp_path: Path) -> None:
    file = tmp_path / "wipe.toml"
    shutil.copy(CATALOGUE / "wipe.toml", file)
    before = load_task(file)
    assert load_task(file) is not before
    file.write_text(file.read_text(encoding="utf-8").replace("[surface]", "[surface]\nfriction = 0.123", 1))
    assert load_task(file) != before
