"""The handle of the target in the scene, dragged with a real mouse."""

from __future__ import annotations

import time

import numpy as np

from pliant.spatial import skew
from tests.live.conftest import Live, until


def pixel(live: Live, point: np.ndarray) -> tuple[float, float]:
    """Where a point of the world (3,) m stands in the browser's window."""
    camera = next(iter(live.server.viser.get_clients().values())).camera
    canvas = live.tab.locator("canvas").first.bounding_box()
    assert canvas is not None
    x, y, z = rotation(camera.wxyz).T @ (point - camera.position)  # x right, y down, z into the picture
    scale = 0.5 * canvas["height"] / np.tan(0.5 * camera.fov)
    middle = canvas["x"] + 0.5 * canvas["width"], canvas["y"] + 0.5 * canvas["height"]
    return middle[0] + scale * x / z, middle[1] + scale * y / z


def rotation(wxyz: np.ndarray) -> np.ndarray:
    """(3, 3) of a unit quaternion."""
    S = skew(wxyz[1:])
    return np.eye(3) + 2.0 * wxyz[0] * S + 2.0 * S @ S


def pull(live: Live, start: np.ndarray, low: float, high: float, patience: float = 1.0) -> np.ndarray:
    """Drags with the mouse from `low` to `high` m above a point. Returns how far the handle went, (3,) m."""
    mouse, handle = live.tab.mouse, live.page.target.handle
    before = np.array(handle.position)
    mouse.move(*pixel(live, start + np.array([0.0, 0.0, low])))
    time.sleep(0.6 * patience)  # the page looks for what is under the mouse once a frame
    mouse.down()
    for height in np.linspace(low, high, 7)[1:]:
        mouse.move(*pixel(live, start + np.array([0.0, 0.0, height])))
        time.sleep(0.15 * patience)
    mouse.up()
    time.sleep(0.3 * patience)
    return np.array(handle.position) - before


def test_a_dragged_target_moves_the_robot(live: Live) -> None:
    """The handle's upward arrow is dragged with the mouse and the tool follows; above the arrow nothing is grabbed."""
    live.open_tab("Touch")
    until(lambda: live.page.target.handle.visible, "the handle")
    live.tab.get_by_role("button", name="Back to the task's target").click()
    live.settle(2.0)
    start = np.array(live.page.target.handle.position)
    assert np.abs(pull(live, start, 0.30, 0.36)).max() == 0.0
    for patience in (1.0, 2.0, 4.0, 8.0):  # a busy machine may draw too slowly to see a quick mouse
        moved = pull(live, start, 0.13, 0.19, patience)
        if moved.any():
            break
    assert 0.03 < moved[2] < 0.09
    assert np.abs(moved[:2]).max() < 5e-3
    live.settle(2.0)
    assert abs(live.latest("error.z")) < 5.0  # mm: the tool is where the handle is
    live.tab.get_by_role("button", name="Back to the task's target").click()
    live.settle(1.0)
