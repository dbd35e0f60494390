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
