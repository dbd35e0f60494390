"""The compiled contact law against a twin that is written to be read, on random scenes of every supported pair."""

from __future__ import annotations

import ctypes
import itertools
from collections.abc import Callable
from pathlib import Path

import mujoco
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pliant._contact import BRISTLE_SIZE, ContactLoop

Vector = np.ndarray

SHAPES = {
    "ball": '<geom name="ball" type="sphere" size=".07" mass="0.5"/>',
    "rod": '<geom name="rod" type="capsule" size=".03 .12" mass="0.7" pos=".01 .02 0" quat=".9 .1 .3 0"/>',
    "brick": '<geom name="brick" type="box" size=".05 .08 .11" mass="2" pos="0 .01 0"/>',
    "anvil": '<geom name="anvil" type="box" size=".2 .1 .06" mass="3" quat=".8 0 .2 .1"/>',
    "bowl": '<geom name="bowl" type="sphere" size=".15" mass="1"/>',
    "shaft": '<geom name="shaft" type="cylinder" size=".06 .1" mass="1" quat=".7 .1 .2 .3"/>',
    "pipe": '<geom name="pipe" type="cylinder" size=".16 .1" mass="1" quat=".7 .3 .2 .1"/>',
    "dish": '<geom name="dish" type="sphere" size=".17" mass="1"/>',
}
XML = (
    '<mujoco><worldbody><geom name="ground" type="plane" size="0 0 1" pos="0 0 .02" quat=".98 .1 .1 0"/>'
    + "".join(f'<body name="{name}" pos="0 0 .2"><freejoint/>{geom}</body>' for name, geom in SHAPES.items())
    + "</worldbody></mujoco>"
)
HOLLOW = ("pipe", "dish")
PAIRS = [
    (a, b)
    for a, b in itertools.product(("ball", "rod", "brick"), ("ground", "anvil", "bowl", "shaft", *HOLLOW))
    if (a, b) not in (("brick", "bowl"), ("brick", "shaft"))
]
MATERIAL = np.array([2e5, 3e2, 1e-3, 0.5, 0.3, 1e-3, 1e5, 2e2])
DT = 2e-5  # s


# ---------------------------------------------------------------------- the twin


def nearest_in_box(p: Vector, half: Vector) -> Vector:
    return np.clip(p, -half, half)


def touch_ball(
    centre: Vector, radius: float, kind: int, size: Vector, x: Vector, R: Vector, hollow: bool
) -> tuple[Vector, Vector, float]:
    """Point, normal and penetration of a ball against a shape."""
    if kind == mujoco.mjtGeom.mjGEOM_PLANE:
        normal = R[:, 2]
        depth = radius - normal @ (centre - x)
    elif kind == mujoco.mjtGeom.mjGEOM_SPHERE or kind == mujoco.mjtGeom.mjGEOM_CYLINDER:
        local = R.T @ (centre - x)
        local[2] *= kind == mujoco.mjtGeom.mjGEOM_SPHERE
        distance = np.linalg.norm(local)
        normal, depth = R @ local / distance, radius + size[0] - distance
        if hollow:
            normal, depth = -normal, radius - (size[0] - distance)
    else:
        local = R.T @ (centre - x)
        nearest = nearest_in_box(local, size)
        distance = np.linalg.norm(local - nearest)
        if distance > 1e-12:
            normal, depth = R @ ((local - nearest) / distance), radius - distance
        else:  # inside: out through the nearest face
            axis = int(np.argmin(size - np.abs(local)))
            normal = R[:, axis] * np.sign(local[axis])
            depth = radius + size[axis] - abs(local[axis])
    return centre - (radius - 0.5 * depth) * normal, normal, depth


def balls_of(
    kind: int, size: Vector, x: Vector, R: Vector, b: tuple[int, Vector, Vector, Vector, bool]
) -> list[tuple[Vector, float]]:
    """What a shape presents to another: centres and radii."""
    if kind == mujoco.mjtGeom.mjGEOM_SPHERE:
        return [(x, size[0])]
    if kind == mujoco.mjtGeom.mjGEOM_BOX:
        signs = [(i, j, k) for k in (-1, 1) for j in (-1, 1) for i in (-1, 1)]
        return [(x + R @ (np.array(s) * size), 0.0) for s in signs]
    start, along = x - size[1] * R[:, 2], 2.0 * size[1] * R[:, 2]
    kind_b, size_b, x_b, R_b, hollow = b
    if kind_b == mujoco.mjtGeom.mjGEOM_PLANE or hollow:
        return [(start, size[0]), (start + along, size[0])]

    def distance(t: float) -> float:
        p = start + t * along
        if kind_b == mujoco.mjtGeom.mjGEOM_SPHERE:
            return float(np.linalg.norm(p - x_b))
        local = R_b.T @ (p - x_b)
        if kind_b == mujoco.mjtGeom.mjGEOM_CYLINDER:
            return float(np.linalg.norm(local[:2]))
        return float(np.linalg.norm(local - nearest_in_box(local, size_b)))

    return [(start + smallest(distance) * along, size[0])]


def smallest(f: Callable[[float], float]) -> float:
    """Where a convex function on [0, 1] is smallest; the middle if that is an interval."""
    ends = []
    for prefer_left in (True, False):
        low, high = 0.0, 1.0
        for _ in range(200):
            a, b = low + (high - low) / 3, high - (high - low) / 3
            fa, fb = f(a), f(b)
            go_left = fa <= fb if prefer_left else fa < fb
            low, high = (low, b) if go_left else (a, high)
        ends.append(0.5 * (low + high))
    return 0.5 * (ends[0] + ends[1])


def force_of(
    m: Vector, normal: Vector, depth: float, velocity: Vector, bristle: Vector, dt: float
) -> tuple[Vector, Vector]:
    """Force on A and the bristle's next state: deflection (3), coefficient, sliding."""
    K, D, w, mu_s, mu_d, v_c, k_t, d_t = m
    if depth <= 0.0:
        return np.zeros(3), np.array([0.0, 0.0, 0.0, mu_s, 0.0])
    u = min(depth / w, 1.0)
    F_n = max(0.0, (3 * u**2 - 2 * u**3) * (K * depth - D * (normal @ velocity)))
    P = np.eye(3) - np.outer(normal, normal)
    v = P @ velocity
    speed = np.linalg.norm(v)
    target = mu_d + (mu_s - mu_d) * np.exp(-((speed / v_c) ** 2)) if bristle[4] else mu_s
    mu = bristle[3] + (target - bristle[3]) * (1 - np.exp(-(1 + speed / v_c) * dt / 1e-3))
    z = P @ bristle[:3] + dt * v
    reach = mu * F_n / k_t
    sliding = float(np.linalg.norm(z) > reach)
    if sliding:
        z *= reach / np.linalg.norm(z)
    friction = -k_t * z - d_t * v
    size = np.linalg.norm(friction)
    if size > mu * F_n:
        friction *= mu * F_n / size
    return F_n * normal + friction, np.array([*z, mu, sliding])


def point_velocity(model: mujoco.MjModel, data: mujoco.MjData, body: int, point: Vector) -> Vector:
    J = np.zeros((3, model.nv))
    mujoco.mj_jac(model, data, J, None, point, body)
    return J @ data.qvel


def twin(model: mujoco.MjModel, data: mujoco.MjData, bristles: Vector) -> tuple[Vector, Vector, Vector, Vector, Vector]:
    """Forces, points, penetrations, bristles and generalised force of all pairs."""
    force, point, depth, after = [], [], [], []
    generalised = np.zeros(model.nv)
    slot = 0
    for a, b in PAIRS:
        ga, gb = model.geom(a), model.geom(b)
        shape_b = (gb.type[0], gb.size, data.geom(b).xpos, data.geom(b).xmat.reshape(3, 3), b in HOLLOW)
        for centre, radius in balls_of(
            ga.type[0], ga.size, data.geom(a).xpos, data.geom(a).xmat.reshape(3, 3), shape_b
        ):
            p, normal, d = touch_ball(centre, radius, *shape_b)
            v = point_velocity(model, data, ga.bodyid[0], p) - point_velocity(model, data, gb.bodyid[0], p)
            f, z = force_of(MATERIAL, normal, d, v, bristles[slot], DT)
            for body, sign in ((ga.bodyid[0], 1.0), (gb.bodyid[0], -1.0)):
                J = np.zeros((3, model.nv))
                mujoco.mj_jac(model, data, J, None, p, body)
                generalised += sign * J.T @ f
            force.append(f)
            point.append(p)
            depth.append(d)
            after.append(z)
            slot += 1
    return np.array(force), np.array(point), np.array(depth), np.array(after), generalised


# ---------------------------------------------------------------------- the comparison


def half_steps() -> tuple[int, int]:
    library = ctypes.CDLL(str(next(Path(str(mujoco.__file__)).parent.glob("libmujoco.so*"))))
    first, second = (ctypes.cast(getattr(library, f), ctypes.c_void_p).value for f in ("mj_step1", "mj_step2"))
    assert first is not None
    assert second is not None
    return first, second


@pytest.fixture(scope="module")
def scene() -> tuple[mujoco.MjModel, mujoco.MjData, ContactLoop]:
    model = mujoco.MjModel.from_xml_string(XML)
    model.geom_contype[:] = 0
    data = mujoco.MjData(model)
    loop = ContactLoop(model, data, *half_steps())
    for a, b in PAIRS:
        loop.add_pair(model.geom(a).id, model.geom(b).id, MATERIAL, b in HOLLOW)
    return model, data, loop


def randomise(model: mujoco.MjModel, data: mujoco.MjData, rng: np.random.Generator) -> None:
    """Bodies crowded together, so that most pairs overlap, at all orientations and speeds."""
    for joint in range(model.njnt):
        at = model.jnt_qposadr[joint]
        data.qpos[at : at + 3] = rng.uniform(-0.12, 0.12, 3) + np.array([0.0, 0.0, 0.08])
        quaternion = rng.standard_normal(4)
        data.qpos[at + 3 : at + 7] = quaternion / np.linalg.norm(quaternion)
    data.qvel[:] = rng.standard_normal(model.nv) * rng.choice([1e-4, 1e-2, 1.0])
    mujoco.mj_step1(model, data)


@given(seed=st.integers(0, 2**31))
def test_forces_points_bristles_and_their_effect_equal_the_twins(
    scene: tuple[mujoco.MjModel, mujoco.MjData, ContactLoop], seed: int
) -> None:
    model, data, loop = scene
    rng = np.random.default_rng(seed)
    randomise(model, data, rng)
    n = loop.slots
    bristles = np.zeros((n, BRISTLE_SIZE))
    bristles[:, :3] = rng.standard_normal((n, 3)) * 1e-5
    bristles[:, 3] = rng.uniform(0.3, 0.5, n)
    bristles[:, 4] = rng.integers(0, 2, n)
    force, point, depth, after, generalised = twin(model, data, bristles)

    got_force, got_point, got_depth = np.full((n, 3), np.nan), np.full((n, 3), np.nan), np.full(n, np.nan)
    assert loop.evaluate(DT, np.zeros((model.nbody, 6)), bristles, got_force, got_point, got_depth)
    got_generalised = np.zeros(model.nv)
    for body in range(1, model.nbody):
        pushed = data.xfrc_applied[body]
        mujoco.mj_applyFT(model, data, pushed[:3], pushed[3:], data.xipos[body], body, got_generalised)

    scale = max(1.0, float(np.abs(force).max()))
    assert np.allclose(bristles, after, rtol=1e-6, atol=1e-12)
    assert np.allclose(got_depth, depth, atol=1e-9)
    assert np.allclose(got_point, point, atol=2e-6)
    assert np.allclose(got_force, force, rtol=1e-5, atol=1e-6 * scale)
    assert np.allclose(got_generalised, generalised, rtol=1e-5, atol=1e-5 * scale)


def test_every_pair_touched_in_the_random_scenes(scene: tuple[mujoco.MjModel, mujoco.MjData, ContactLoop]) -> None:
    """The comparison above would prove nothing about shapes that never meet."""
    model, data, loop = scene
    n = loop.slots
    met = np.zeros(n, dtype=bool)
    penetration = np.zeros(n)
    for seed in range(40):
        randomise(model, data, np.random.default_rng(seed))
        loop.evaluate(DT, np.zeros((model.nbody, 6)), np.zeros((n, 5)), np.zeros((n, 3)), np.zeros((n, 3)), penetration)
        met |= penetration > 0.0
    assert met.all()
