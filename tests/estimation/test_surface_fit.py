"""A surface's tilt from the places that a tool touched: what it finds, what it knows that it does not know."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pliant.environment import EstimatedSurface
from pliant.errors import ConfigError
from pliant.estimation import SurfaceEstimator, SurfaceFitConfig
from pliant.guard.sound import is_estimate
from pliant.robot import Robot
from pliant.signals import Estimate, Measurement
from pliant.spatial import Array
from pliant.surfaces import CylinderSurface, PlaneSurface, SphereSurface, SurfaceGeometry

RADIUS, STIFFNESS, FORCE, FRICTION = 0.015, 2e4, 25.0, 0.25  # m, N/m, N, 1
LYING = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])  # axis along x
SURFACES: dict[str, SurfaceGeometry] = {
    "plane": PlaneSurface(np.zeros(3), np.eye(3)),
    "cylinder": CylinderSurface(np.array([0.0, 0.0, -0.15]), LYING, radius=0.15),
    "sphere": SphereSurface(np.array([0.0, 0.0, -0.2]), np.eye(3), radius=0.2),
}
LINE = np.array([[0.001 * k, 0.0] for k in range(121)])
TURN = np.array([[0.12, 0.001 * k] for k in range(1, 21)])
BACK = LINE[::-1] + np.array([0.0, 0.02])


class Felt:
    """An estimator that says what it is told: where the tool is, and what pushes on it."""

    wrench: Array = np.zeros(6)

    def init(self, measurement: Measurement) -> None:
        return None

    def step(self, measurement: Measurement, state: None) -> tuple[Estimate, None]:
        m = measurement
        touches = bool(self.wrench.any())
        return Estimate(m.time, m.q, m.v, m.torque, m.torque_sent, {"tip": self.wrench}, {"tip": touches}), None


@pytest.fixture(scope="module")
def gantry(tmp_path_factory: pytest.TempPathFactory) -> Robot:
    """Three sliding joints: q is the place of the tip."""
    links = "".join(
        f'<link name="{name}"><inertial><mass value="1"/><inertia ixx="1e-2" iyy="1e-2" izz="1e-2" ixy="0" ixz="0"'
        ' iyz="0"/></inertial></link>'
        for name in ("base", "x", "y", "tip")
    )
    joints = "".join(
        f'<joint name="j{child}" type="prismatic"><parent link="{parent}"/><child link="{child}"/><axis xyz="{axis}"/>'
        '<limit lower="-1" upper="1" effort="100" velocity="1"/></joint>'
        for parent, child, axis in (("base", "x", "1 0 0"), ("x", "y", "0 1 0"), ("y", "tip", "0 0 1"))
    )
    path = tmp_path_factory.mktemp("gantry") / "gantry.urdf"
    path.write_text(f'<robot name="gantry">{links}{joints}</robot>')
    return Robot.load(path, home=np.zeros(3))


def touched(
    robot: Robot, believed: SurfaceGeometry, true: SurfaceGeometry, way: Array, noise: float, seed: int, each: int = 5
) -> tuple[EstimatedSurface, Array, Array]:
    """What is felt at the end of a way over the true surface, the true normal there, and the force's direction."""
    rng, inner = np.random.default_rng(seed), Felt()
    estimator = SurfaceEstimator(inner, robot, "tip", believed, SurfaceFitConfig(RADIUS, STIFFNESS))
    top, zero = true.top(), np.zeros(3)
    places, normals = true.chart(top, true.tangent(top, (1.0, 0.0, 0.0)), way)
    state, estimate, before = None, None, places[0]
    for k in range(each * len(way)):
        place, normal = places[k // each], normals[k // each]
        ahead = place - before
        sliding = ahead / np.linalg.norm(ahead) if ahead.any() else zero
        inner.wrench = np.concatenate([FORCE * (normal - FRICTION * sliding), zero])
        q = place + (RADIUS - FORCE / STIFFNESS) * normal + noise * rng.standard_normal(3)
        now = Measurement(1e-3 * k, q, zero, zero, zero)
        state = estimator.init(now) if state is None else state
        estimate, state = estimator.step(now, state)
        before = places[max(k // each - 1, 0)]
    assert estimate is not None
    push = inner.wrench[:3] / np.linalg.norm(inner.wrench[:3])
    return estimate.surfaces["tip"], normals[-1], push


def angle(a: Array, b: Array) -> float:
    """Degrees."""
    return math.degrees(math.acos(float(np.clip(a @ b, -1.0, 1.0))))


@settings(max_examples=40)
@given(
    shape=st.sampled_from(sorted(SURFACES)),
    tilt=st.tuples(*[st.floats(-4.0, 4.0)] * 2),
    shift=st.floats(-4e-3, 4e-3),
    seed=st.integers(0, 1000),
)
def test_a_line_and_a_turn_tell_the_normal(
    gantry: Robot, shape: str, tilt: tuple[float, float], shift: float, seed: int
) -> None:
    """Within 1° for surfaces up to 4° and 4 mm off, readings with 0.2 mm of noise; what says 14° is the force."""
    believed = SURFACES[shape]
    true = believed.moved((0.0, 0.0, shift), np.radians([*tilt, 0.0]), believed.top())
    felt, normal, push = touched(gantry, believed, true, np.concatenate([LINE, TURN, BACK[:40]]), 2e-4, seed)
    assert angle(felt.normal, normal) < 1.0
    assert angle(push, normal) > 12.0  # the friction angle


def test_one_line_leaves_the_other_direction_open(gantry: Robot) -> None:
    believed = SURFACES["plane"]
    true = believed.moved(0.0, np.radians([3.0, 3.0, 0.0]))
    along, _, _ = touched(gantry, believed, true, LINE, 2e-4, 0)
    both, _, _ = touched(gantry, believed, true, np.concatenate([LINE, TURN, BACK]), 2e-4, 0)
    assert along.normal_std > math.radians(4.5)  # of 5 that were believed
    assert both.normal_std < math.radians(0.6)
    assert abs(math.degrees(along.turn[0])) < 0.5  # about the line nothing was found
    np.testing.assert_allclose(np.degrees(along.turn[1]), 3.0, atol=0.3)
    np.testing.assert_allclose(np.degrees(both.turn[:2]), 3.0, atol=0.3)


def test_the_uncertainty_covers_the_error(gantry: Robot) -> None:
    """Of 30 surfaces, at most a tenth is further off than twice what the estimate says of itself."""
    rng, off = np.random.default_rng(1), 0
    for seed in range(30):
        believed = SURFACES["plane"]
        true = believed.moved(0.0, np.radians([*rng.uniform(-4.0, 4.0, 2), 0.0]))
        felt, normal, _ = touched(gantry, believed, true, np.concatenate([LINE[::2], TURN[:10]]), 2e-4, seed)
        off += math.radians(angle(felt.normal, normal)) > 2.0 * felt.normal_std
    assert off <= 3


def test_standing_still_teaches_nothing(gantry: Robot) -> None:
    """Noise of 0.3 mm is no way: the uncertainty stays what it was."""
    plane = SURFACES["plane"]
    felt, _, _ = touched(gantry, plane, plane, np.zeros((1, 2)), 3e-4, 0, each=4000)
    assert felt.normal_std > math.radians(4.9)
    assert np.linalg.norm(felt.turn) < math.radians(0.2)


def test_nothing_is_felt_before_contact(gantry: Robot) -> None:
    estimator = SurfaceEstimator(Felt(), gantry, "tip", SURFACES["plane"], SurfaceFitConfig())
    now = Measurement(0.0, np.zeros(3), np.zeros(3), np.zeros(3), np.zeros(3))
    estimate, _ = estimator.step(now, estimator.init(now))
    assert not estimate.surfaces


@pytest.mark.parametrize("name", ["stiffness", "spacing", "turn_std", "place_std", "shift_std", "radius"])
@pytest.mark.parametrize("value", [-1.0, math.nan, math.inf])
def test_impossible_numbers_are_named(name: str, value: float) -> None:
    with pytest.raises(ConfigError, match=name):
        SurfaceFitConfig(**{name: value})


@pytest.mark.parametrize("part", ["turn", "normal", "normal_std"])
def test_the_guard_notices_one_that_is_not_sound(part: str) -> None:
    sound = EstimatedSurface(np.zeros(3), np.zeros(3), np.array([0.0, 0.0, 1.0]), math.inf)
    broken = replace(sound, **{part: math.nan if part == "normal_std" else np.array([0.0, math.nan, 0.0])})
    zero = np.zeros(3)
    for surface, expected in ((sound, True), (broken, False)):
        estimate = Estimate(0.0, zero, zero, zero, zero, surfaces={"tip": surface})
        assert is_estimate(estimate, 3) is expected
