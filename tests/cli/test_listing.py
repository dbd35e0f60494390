"""What `pliant list` says of what is not there."""

from __future__ import annotations

import pytest

from pliant.cli import listing
from pliant.robots import CATALOGUE


@pytest.mark.parametrize("there", [True, False])
def test_a_robot_that_is_not_installed_has_its_remedy(there: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(listing, "is_available", lambda entry: there)
    names, _, texts = ([str(cell) for cell in column.cells] for column in listing._robots().columns)
    for name, text in list(zip(names, texts, strict=True))[:-1]:
        assert text.startswith(CATALOGUE[name].description)
        assert ("(not installed: pip install " in text) is not there


def test_a_list_of_phases_says_what_it_touches_and_how_many_they_are() -> None:
    """Neither the default surface nor the default path, which such a task does not have; a path keeps its own."""
    columns = [[str(cell) for cell in column.cells] for column in listing._tasks().columns]
    names, _, things, paths, _ = columns
    told = {name.removeprefix("  --case "): pair for name, *pair in zip(names, things, paths, strict=True)}
    assert told["figure8-plain"] == ["nothing", "lemniscate"]
    assert told["figure8-wall"] == ["plane", "lemniscate"]
    assert told["experiment-4"] == ["plane, ball", "5 phases"]
    assert told["wipe-cylinder"] == ["cylinder", "raster"]
    assert told["polish-circle"] == ["plane", "circle"]
