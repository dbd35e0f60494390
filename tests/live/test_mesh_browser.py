"""A part of triangles on the page, and messages that leave its controls free."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser

from pliant.configuration import merged
from pliant.experiments.registry import get_study
from pliant.live.link.messages import Note
from tests.live.conftest import Live, served, until

pytestmark = pytest.mark.study
MESSAGE = "t = 2 s: 60 N along z are out of reach, 32.3 N is all that x_b = 0.025 m allows there. " * 2
_COVERED = """() => {
  const seen = e => { const r = e.getBoundingClientRect(); return r.width > 0 && r.height > 0 ? [r] : [] };
  const rects = what => [...document.querySelectorAll(what)];
  const messages = rects('[role=alert]').flatMap(seen);
  const controls = rects('button, input, [role=slider], [role=tab]').filter(e => !e.closest('[role=alert]'));
  const over = (a, b) => a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;
  const under = controls.flatMap(seen).filter(c => messages.some(m => over(c, m)));
  return [messages.length, controls.length, under.length];
}"""
"""messages, controls, and how many of these lie under one"""
_OVER_PAUSE = """() => {
  const button = [...document.querySelectorAll('button')].find(e => e.textContent.includes('Pause'));
  const at = button.getBoundingClientRect(), messages = document.querySelectorAll('[role=alert]');
  for (const e of messages)
    e.style.cssText += `;position:fixed;transform:none;left:${at.x}px;top:${at.y}px`;
}"""


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


@pytest.mark.parametrize(("width", "height"), [(1280, 800), (900, 600)])
def test_messages_leave_the_controls_free(part: Live, width: int, height: int) -> None:
    """Control: messages that are put over a button are found there. At 844 x 390 one of 57 controls is covered."""
    tab = part.tab
    tab.set_viewport_size({"width": width, "height": height})
    tab.reload()
    tab.get_by_role("button", name="Pause").wait_for()

    def free() -> bool:
        messages, controls, under = tab.evaluate(_COVERED)
        if messages == 0:  # it closes by itself, and one that is sent while the page loads is lost
            part.page._note(Note("note", MESSAGE))
            tab.wait_for_timeout(1000)
        return messages > 0 and controls > 5 and under == 0

    until(free, "messages beside the controls")  # they slide in, and curves fold
    tab.evaluate(_OVER_PAUSE)
    assert tab.evaluate(_COVERED)[2] > 0
