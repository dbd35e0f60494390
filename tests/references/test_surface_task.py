"""A task on a surface: what its references promise on any surface, path and pose, and how it fails in order."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import pytest

from pliant.errors import ConfigError, RunFailedError
from pliant.interfaces import Lookahead
from pliant.references.phases import TaskPhase
from pliant.references.postures.inverse_kinematics import Target
from pliant.references.postures.posture import UnreachableError
from pliant.references.surface_task import SurfaceTask, SurfaceTaskSettings, surface_task
from pliant.references.toolpaths.patterns import PATTERNS, line
from pliant.references.toolpaths.pressing import PressingForce
from pliant.references.toolpaths.toolpath import PathMotion, Toolpath, on_chart
from pliant.references.trajectories.trajectory import Hold
from pliant.signals import Estimate, Reference
from pliant.spatial import exp3, log3, rpy
from pliant.surfaces import CylinderSurface, PlaneSurface, SphereSurface, SurfaceGeometry
from tests.references.ball_arm import PROFILE, RADIUS, ROBOT, X

DT = 5e-3  # s
AHEAD = Lookahead(nodes=4, step=0.01, lead=0.005)


@dataclass
class Played:
    """A task that was played against a surface which is really elsewhere."""

    task: SurfaceTask
    surface: SurfaceGeometry
    path: Toolpath
    speed: float
    height: float
    references: list[Reference]


def estimate(time: float, q: np.ndarray, touching: bool) -> Estimate:
    zero = np.zeros(ROBOT.n)
    return Estimate(time, q, zero, zero, zero, contacts={"tool": touching})


def drawn_surface(rng: np.random.Generator) -> SurfaceGeometry:
    """In front of the arm, leaning by 25° or less."""
    place = np.array([0.55, 0.0, 0.15]) + rng.uniform(-0.08, 0.08, 3)
    lean = rpy(*rng.uniform(-0.4, 0.4, 2), rng.uniform(-3.0, 3.0))
    kind = rng.integers(3)
    if kind == 0:
        return PlaneSurface(place, lean)
    if kind == 1:
        radius = rng.uniform(0.1, 0.3)
        return CylinderSurface(place - [0.0, 0.0, radius], lean @ exp3([0.5 * math.pi, 0.0, 0.0]), radius)
    radius = rng.uniform(0.1, 0.3)
    return SphereSurface(place - [0.0, 0.0, radius], lean, radius)


def play(task: SurfaceTask, height: float) -> list[Reference]:
    """Every reference, contact being felt where the ball meets a surface that is higher by `height` m. The joints are
    those that belong to the reference, but do not go below the surface."""
    source = task.source(AHEAD)
    first = task.phases[1].motion.at(0.0).value
    axes = task.phases[1].axes
    assert axes is not None
    normal = axes.at(0.0).rotation[:, 2]
    q, touching = task.start, False
    state = source.init(estimate(0.0, q, False))
    found: list[Reference] = []
    for tick in range(round((task.duration + 0.2) / DT)):
        reference, state = source.step(estimate(tick * DT, q, touching), state)
        found.append(reference)
        assert reference.posture is not None
        if not touching and normal @ (reference.tasks[0].position - first) < height:
            touching = True  # the arm lags behind by a millimetre
            shifted = pin_to(reference.posture, first + (height + 1e-3) * normal)
            q = shifted
    return found


def pin_to(q: np.ndarray, point: np.ndarray) -> np.ndarray:
    """Joints near q whose tool is at a point."""
    from pliant.references.postures.ik_aico import AicoSolver
    from pliant.references.postures.inverse_kinematics import joint_box

    for _ in range(3):
        q = AicoSolver(ROBOT, "tool").solve(q, q, joint_box(ROBOT), Target(point, None))
    return q


def played(seed: int) -> Played:
    rng = np.random.default_rng(seed)
    surface = drawn_surface(rng)
    pattern, speed = sorted(PATTERNS)[seed % len(PATTERNS)], rng.uniform(0.04, 0.08)
    size = rng.uniform(0.03, 0.05)
    motion = PathMotion(speed, 0.5, tilt=rng.uniform(-0.2, 0.2), lift=RADIUS)
    start = surface.near(np.array([0.55, 0.0, 0.9])).point
    path = on_chart(surface, start, X, PATTERNS[pattern]((size, 0.6 * size), 0.3 * size, 1.0), motion, X)
    settings = SurfaceTaskSettings(stand_off=0.03, press=0.2, leave=0.3, spins=bool(seed % 2))
    height = rng.uniform(-0.004, 0.004)
    task = surface_task(ROBOT, "tool", path, PROFILE, settings)
    return Played(task, surface, path, speed, height, play(task, height))


@pytest.fixture(scope="module", params=range(6))
def case(request: pytest.FixtureRequest) -> Played:
    return played(request.param)


def test_references_are_continuous_in_pose_normal_and_wrench(case: Played) -> None:
    fastest = max(0.05 * 1.01, 1.02 * case.speed * (1.0 + 0.02 / 0.1), 1.9 * 0.03 / 0.3)
    for before, after in zip(case.references, case.references[1:], strict=False):
        a, b = before.tasks[0], after.tasks[0]
        assert np.linalg.norm(b.position - a.position) < fastest * DT
        assert np.linalg.norm(b.velocity[:3] - a.velocity[:3]) < 25.0 * DT  # m/s²: the landing, from 0.05 m/s in 0.1 s
        assert a.rotation is not None
        assert b.rotation is not None
        assert np.linalg.norm(log3(b.rotation @ a.rotation.T)) < 4.0 * DT
        assert a.task_rotation is not None
        assert b.task_rotation is not None
        assert np.linalg.norm(log3(b.task_rotation @ a.task_rotation.T)) < 1.2 * case.speed / 0.1 * DT + 1e-9
        assert before.posture is not None
        assert after.posture is not None
        assert np.abs(after.posture - before.posture).max() < 2.0 * DT
        assert np.linalg.norm(b.wrench - a.wrench) < 1500.0 * DT
    phases = [reference.phase for reference in case.references]
    order = [name for i, name in enumerate(phases) if i == 0 or name != phases[i - 1]]
    assert order == ["approach", "press", "follow", "release", "leave"]


def test_on_the_surface_at_its_speed_with_the_force_along_its_normal(case: Played) -> None:
    """Within 2 % of the speed wherever the path runs at it, measured on the surface."""
    follow = [reference for reference in case.references if reference.phase == "follow"]
    start = follow[0].time
    for reference in follow[:: max(len(follow) // 60, 1)]:
        task, time = reference.tasks[0], reference.time - start
        here = case.surface.near(task.position)
        assert here.distance == pytest.approx(RADIUS + case.height + 1e-3, abs=1e-4)
        np.testing.assert_allclose(task.task_rotation[:, 2], here.normal, atol=2e-3)  # type: ignore[index]
        force = float(here.normal @ task.wrench[:3])
        share = float(case.path.share.at(time).value[0])
        assert force == pytest.approx(np.interp(share, PROFILE.knots, PROFILE.forces), rel=1e-4)
        np.testing.assert_allclose(task.wrench[:3], force * here.normal, atol=3e-3 * force)
        ahead = case.surface.near(task.position + 1e-3 * task.velocity[:3]).point
        on_surface = float(np.linalg.norm(ahead - here.point)) / 1e-3
        asked = case.path.length * float(case.path.share.at(time).rate[0])
        assert on_surface < 1.02 * case.speed
        assert on_surface == pytest.approx(asked, rel=0.02, abs=0.02 * case.speed)


def test_each_node_of_the_preview_is_a_later_reference(case: Played) -> None:
    """Once contact is made, everything to come is known."""
    first = next(i for i, reference in enumerate(case.references) if reference.phase == "press")
    for index in range(first, len(case.references) - 40, 17):
        preview = case.references[index].preview
        assert preview is not None
        assert preview.task_rotation is not None
        assert preview.posture is not None
        for node in range(AHEAD.nodes + 1):
            later = case.references[index + round((AHEAD.lead + node * AHEAD.step) / DT)]
            task = later.tasks[0]
            assert preview.phase[node] == later.phase
            np.testing.assert_allclose(preview.position[node], task.position, atol=1e-9)
            np.testing.assert_allclose(preview.rotation[node], task.rotation, atol=1e-9)  # type: ignore[arg-type]
            np.testing.assert_allclose(preview.velocity[node], task.velocity, atol=1e-7)
            np.testing.assert_allclose(preview.wrench[node], task.wrench, atol=1e-6)
            np.testing.assert_allclose(preview.task_rotation[node], task.task_rotation, atol=1e-9)  # type: ignore[arg-type]
            np.testing.assert_allclose(preview.posture[node], later.posture, atol=1e-9)  # type: ignore[arg-type]


def test_the_posture_leads_to_the_reference(case: Played) -> None:
    for reference in case.references[::50]:
        if reference.phase in ("press", "follow"):
            lifted = case.height + 1e-3  # the posture was solved on the believed surface
            position, R = ROBOT.placement(reference.posture, "tool")  # type: ignore[arg-type]
            assert np.linalg.norm(position - reference.tasks[0].position) < abs(lifted) + 3e-3
            assert np.linalg.norm(log3(R @ reference.tasks[0].rotation.T)) < 5e-3  # type: ignore[union-attr]


# ---------------------------------------------------------------------- failing in order


@pytest.fixture(scope="module")
def short() -> SurfaceTask:
    plane = PlaneSurface(np.array([0.55, 0.0, 0.15]), np.eye(3))
    path = on_chart(plane, plane.origin, X, line((0.02, 0.0)), PathMotion(lift=RADIUS), X)
    return surface_task(ROBOT, "tool", path, PressingForce.constant(10.0), SurfaceTaskSettings(stand_off=0.05))


def test_a_surface_that_is_not_there_ends_the_run_in_one_sentence(short: SurfaceTask) -> None:
    source = short.source()
    state = source.init(estimate(0.0, short.start, False))
    end = short.phases[0].patience
    assert end == pytest.approx((0.05 + 0.03) / 0.05 + 0.1 + 0.5)
    reference, state = source.step(estimate(end - 1e-3, short.start, False), state)
    assert reference.phase == "approach"
    assert reference.tasks[0].position[2] == pytest.approx(0.15 + RADIUS - 0.03)  # and no deeper
    with pytest.raises(RunFailedError, match=r"phase 'approach' felt no contact of frame 'tool' within 2.2 s"):
        source.step(estimate(end + 1e-3, short.start, False), state)


def test_contact_far_from_the_surface_is_a_failure(short: SurfaceTask) -> None:
    source = short.source()
    state = source.init(estimate(0.0, short.start, False))
    _, state = source.step(estimate(0.0, short.start, False), state)
    with pytest.raises(RunFailedError, match=r"contact was felt 50 mm above the believed surface, more than the 30 mm"):
        source.step(estimate(0.002, short.start, True), state)


def test_the_times_of_the_phases_are_those_of_a_surface_where_it_is_believed(short: SurfaceTask) -> None:
    assert short.begins["press"] == pytest.approx(0.05 / 0.05 + 0.1)
    assert short.begins["release"] == pytest.approx(short.begins["follow"] + 0.02 / 0.05 + 0.1, abs=1e-3)
    assert short.begins["leave"] == pytest.approx(short.begins["release"] + 0.2)
    assert short.duration == pytest.approx(short.begins["leave"] + 0.5)
    assert short.longest == pytest.approx(short.duration + 0.03 / 0.05 + 0.5, abs=1e-6)


def test_what_cannot_be_reached_is_said() -> None:
    plane = PlaneSurface(np.array([1.4, 0.0, 0.15]), np.eye(3))
    path = on_chart(plane, plane.origin, X, line((0.02, 0.0)), PathMotion(lift=RADIUS), X)
    with pytest.raises(UnreachableError, match="cannot reach"):
        surface_task(ROBOT, "tool", path, PROFILE)


def test_settings_that_make_no_sense_are_refused() -> None:
    with pytest.raises(ConfigError, match="search of a task on a surface must be above zero, got 0"):
        SurfaceTaskSettings(search=0.0)
    with pytest.raises(ConfigError, match="five phases of different names"):
        SurfaceTaskSettings(names=("a", "a", "b", "c", "d"))
    with pytest.raises(ConfigError, match="anchored to a surface: give its axes"):
        TaskPhase("follow", Hold(np.zeros(3)), "surface")
