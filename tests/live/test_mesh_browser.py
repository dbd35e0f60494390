"""A part of triangles on the page."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser

from pliant.configuration import merged
from pliant.experiments.registry import get_study
from tests.live.conftest import Live, served, until

pytestmark = pytest.mark.study


@pytest.fixture(scope="module")
def part(browser: Browser, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Live]:
    case = merged(get_study("wipe-part").case("wipe-part"), {"phases": {"stand_off": 0.01, "press": 0.2}})
    with served(browser, tmp_path_factory.mktemp("logs"), "wipe-part", case) as made:
        yield made


def test_a_part_of_triangles_is_seen_and_touched(part: Live) -> None:
    """Its distances go from the loop's process to the page's."""
    until(lambda: part.latest("contact") > 1.0, "its contact")
    assert [type(face.geometry).__name__ for face in part.page.view.faces] == ["MeshSurface"]
    part.shoot("part")
