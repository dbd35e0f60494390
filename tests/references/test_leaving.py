"""How a task on a surface that stands otherwise than believed leaves it."""

from __future__ import annotations

import numpy as np
import pytest

from pliant.references.postures.ik_aico import AicoSolver
from pliant.references.postures.inverse_kinematics import Target, joint_box
from pliant.references.surface_task import SurfaceTask, SurfaceTaskSettings, surface_task
from pliant.references.toolpaths.patterns import line
from pliant.references.toolpaths.pressing import PressingForce
from pliant.references.toolpaths.toolpath import PathMotion, on_chart
from pliant.signals import Estimate, Reference
from pliant.spatial import Array
from pliant.surfaces import PlaneSurface
from tests.references.ball_arm import RADIUS, ROBOT, X

DT = 5e-3  # s
LANDED = 0.002  # m, of the contact above the believed surface
FIRST, LAST = np.array([0.55, 0.0, 0.15 + RADIUS]), np.array([0.57, 0.0, 0.15 + RADIUS])


@pytest.fixture(scope="module")
def task() -> SurfaceTask:
    plane = PlaneSurface(FIRST - [0.0, 0.0, RADIUS], np.eye(3))
    path = on_chart(plane, plane.origin, X, line((0.02, 0.0)), PathMotion(lift=RADIUS), X)
    settings = SurfaceTaskSettings(stand_off=0.02, press=0.1)
    return surface_task(ROBOT, "tool", path, PressingForce.constant(10.0), settings)


def joints(near: Array, place: Array) -> Array:
    """(n,) rad, with the tool at a place (3,) m."""
    for _ in range(3):
        near = AicoSolver(ROBOT, "tool").solve(near, near, joint_box(ROBOT), Target(place, None))
    return near


def played(task: SurfaceTask, ends: float) -> list[Reference]:
    """References of a run that lands on `LANDED` and whose tool is at the height `ends` (m) where the path ends."""
    up, zero = np.array([0.0, 0.0, 1.0]), np.zeros(ROBOT.n)
    landed, ended = joints(task.start, FIRST + LANDED * up), joints(task.start, LAST + ends * up)
    source, q, touching = task.source(), task.start, False
    state = source.init(Estimate(0.0, q, zero, zero, zero, contacts={"tool": False}))
    found: list[Reference] = []
    for tick in range(round(task.duration / DT)):
        now = Estimate(tick * DT, q, zero, zero, zero, contacts={"tool": touching})
        reference, state = source.step(now, state)
        found.append(reference)
        touching = touching or reference.tasks[0].position[2] < FIRST[2] + LANDED
        q = ended if reference.phase in ("follow", "release") else landed if touching else task.start
    return found


@pytest.mark.parametrize(("ends", "leaves"), [(0.007, 0.007), (-0.003, LANDED)])
def test_the_tool_leaves_from_where_it_is_and_does_not_go_deeper_first(
    ends: float, leaves: float, task: SurfaceTask
) -> None:
    """Without a jump. A tool that is below the reference, the control, is led as before."""
    made = played(task, ends)
    height = {name: [one.tasks[0].position[2] - LAST[2] for one in made if one.phase == name]
              for name in ("follow", "release", "leave")}  # fmt: skip
    assert (height["follow"][-1], height["release"][0]) == pytest.approx((LANDED, LANDED), abs=2e-4)
    assert (height["release"][-1], height["leave"][0]) == pytest.approx((leaves, leaves), abs=2e-4)
    assert np.min(np.diff(height["release"])) > -1e-9
    assert np.max(np.diff(height["release"])) < 0.15 * DT  # m/s
    assert height["leave"][-1] == pytest.approx(leaves + 0.02, abs=1e-3)
