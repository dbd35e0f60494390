"""What the reach check says is possible is, by an independent run of the joints along the course."""

from __future__ import annotations

import math

import numpy as np
import pinocchio as pin

from pliant.references.reach import Course, ReachCheck
from pliant.references.toolpaths.patterns import circle, line
from pliant.references.trajectories.spline import Spline
from pliant.spatial import exp3, log3, rpy
from pliant.surfaces import CylinderSurface, PlaneSurface, SphereSurface, SurfaceGeometry
from tests.references.reach_courses import ROBOT, course_on, on_plane, quick, torque_share


def driven(course: Course, check: ReachCheck, spins: bool) -> str:
    """Drives the joints along the course by differential kinematics, with stops at the limits of position and speed.

    Says what went wrong, if anything did. Shares no code with the check but the posture that it proposes.
    """
    assert check.posture is not None
    model, data, frame = ROBOT.model, ROBOT.model.createData(), ROBOT.frame_id("tool")
    wanted, motion = Spline(check.posture.times, check.posture.postures), course.motion("tool")
    axes, dt, q = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED, 0.01, check.posture.postures[0].copy()
    for tick in range(round(float(course.times[-1]) / dt)):
        task = motion.at(tick * dt)
        assert task.rotation is not None
        pin.framesForwardKinematics(model, data, q)
        x, R = np.array(data.oMf[frame].translation), np.array(data.oMf[frame].rotation)
        tilt = np.cross(R[:, 2], task.rotation[:, 2]) if spins else log3(task.rotation @ R.T)
        miss = float(np.linalg.norm(task.position - x))
        if miss > 3e-3 or np.linalg.norm(tilt) > 0.02:
            return f"{1e3 * miss:.1f} mm and {np.linalg.norm(tilt):.3f} rad off at {tick * dt:.2f} s"
        J = pin.computeFrameJacobian(model, data, q, frame, axes)
        turning = (np.eye(3) - np.outer(R[:, 2], R[:, 2])) @ J[3:] if spins else J[3:]
        A = np.vstack([J[:3], turning])
        rate = np.concatenate([task.velocity[:3] + 20.0 * (task.position - x), 20.0 * tilt])
        spin = task.velocity[3:]
        rate[3:] += spin - R[:, 2] * (R[:, 2] @ spin) if spins else spin
        inverse = np.linalg.pinv(A, rcond=1e-6)
        v = inverse @ rate + (np.eye(ROBOT.n) - inverse @ A) @ (20.0 * (wanted.at(tick * dt).value - q))
        v = np.clip(v, -ROBOT.velocity_limit, ROBOT.velocity_limit)
        q = np.clip(q + dt * v, ROBOT.position_lower, ROBOT.position_upper)
        if tick % 10 == 0:
            sample = int(np.argmin(np.abs(course.times - tick * dt)))
            overloaded = torque_share(q, course.normals[sample], course.force[sample])
            if overloaded > 1.02:  # 2 %: the instant of a sample and that of the run differ
                return f"a joint at {overloaded:.2f} of its torque limit"
    return ""


def drawn(seed: int) -> tuple[Course, bool]:
    """A task somewhere from the middle of the workspace to beyond its border."""
    rng = np.random.default_rng(seed)
    place = np.array([rng.uniform(0.45, 0.75), rng.uniform(-0.2, 0.2), rng.uniform(0.0, 0.35)])
    lean = rpy(*rng.uniform(-0.4, 0.4, 2), 0.0)
    kind, radius = seed % 3, rng.uniform(0.1, 0.3)
    surface: SurfaceGeometry = PlaneSurface(place, lean)
    if kind == 1:
        surface = CylinderSurface(place - radius * lean[:, 2], lean @ exp3([0.5 * math.pi, 0.0, 0.0]), radius)
    if kind == 2:
        surface = SphereSurface(place - radius * lean[:, 2], lean, radius)
    uv = circle((0.08, 0.06), 1.0) if seed % 2 else line((0.1, 0.05))
    return course_on(surface, place, uv, rng.uniform(0.1, 0.3), rng.uniform(5.0, 60.0)), bool(rng.integers(2))


def test_what_is_said_to_be_reachable_is() -> None:
    """20 drawn tasks, both answers among them."""
    answers: list[bool] = []
    for seed in range(20):
        course, spins = drawn(seed)
        check = quick(course, spins)
        answers.append(check.reachable)
        if check.reachable:
            assert driven(course, check, spins) == "", f"seed {seed}"
    assert 5 <= sum(answers) <= 15


def test_the_run_notices_what_the_check_would_have_to_say() -> None:
    """The run is no rubber stamp: with an overload, with slow joints it fails."""
    course = on_plane(0.55)
    good = quick(course)
    assert good.reachable
    assert driven(course, good, False) == ""
    heavy = on_plane(0.55, force=800.0)
    assert not quick(heavy).reachable
    assert "torque limit" in driven(heavy, good, False)
    elsewhere = on_plane(0.65)
    assert "off at" in driven(elsewhere, good, False)
