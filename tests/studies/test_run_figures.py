"""Figures of a run: pictures are rendered beside the others, and files keep their order."""

from __future__ import annotations

import threading
from pathlib import Path

import mujoco
import numpy as np
import pytest
from matplotlib.figure import Figure

from pliant.experiments.registry import get_study
from pliant.simulation.snapshot import Camera, Snapshot
from pliant.studies import figures
from pliant.telemetry.plots import style

MODEL = mujoco.MjModel.from_xml_string("<mujoco><worldbody><geom type='sphere' size='0.1'/></worldbody></mujoco>")


def test_what_is_waited_for_is_drawn_last_and_stands_in_its_place(tmp_path: Path) -> None:
    config, drawn = get_study("haptic").case("floor"), list[str]()

    def later(name: str, figure: Figure | None) -> figures.Later:
        def made() -> Figure | None:
            drawn.append(f"{name} with {len(list(tmp_path.glob('*.png')))} files there")
            return figure

        return made

    given = {
        "scene": later("scene", style.figure(1.0, 1.0)),
        "history": style.figure(1.0, 1.0),
        "none": None,
        "dark": later("dark", None),
        "map": style.figure(1.0, 1.0),
    }
    files = figures.saved_figures(config, tmp_path, given)
    assert [file.name.rsplit("_", 1)[1] for file in files] == ["scene.png", "history.png", "map.png"]
    assert drawn == ["scene with 2 files there", "dark with 3 files there"]


def test_rendering_begins_before_it_is_waited_for(monkeypatch: pytest.MonkeyPatch) -> None:
    begun, may_end = threading.Event(), threading.Event()

    def render(*_: object, width: int, height: int) -> list[np.ndarray]:
        begun.set()
        assert may_end.wait(10.0)
        return [np.full((height, width, 3), 7)]

    monkeypatch.setattr(figures, "render", render)
    seen: list[tuple[int, ...]] = []

    def draw(pictures: list[np.ndarray]) -> Figure:
        seen.extend(picture.shape for picture in pictures)
        return style.figure(1.0, 1.0)

    later = figures.pictures_later(MODEL, [Snapshot(np.zeros(0))], Camera(), (4, 3), draw)
    assert begun.wait(10.0)
    assert not seen
    may_end.set()
    assert later() is not None
    assert seen == [(3, 4, 3)]


def test_a_machine_that_cannot_render_has_no_picture(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(figures, "render", lambda *_, **__: None)
    later = figures.pictures_later(MODEL, [], Camera(), (4, 3), lambda _: pytest.fail("nothing to draw"))
    assert later() is None
