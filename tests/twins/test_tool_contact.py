"""Tools of several points against a twin that is written to be read: random poses, speeds and bristles."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import mujoco
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pliant._contact import BRISTLE_SIZE, RIM, ContactLoop, Solid
from tests.twins import contact_solids_twin as twin
from tests.twins.test_contact_law import DT, MATERIAL, force_of, half_steps, point_velocity, randomise, touch_ball

Vector = np.ndarray
HOLE, EDGE = (0.05, 0.06, 0.01), (1.3, 0.02)
PEG, BLOCK, ANVIL = (0.045, 0.09), np.array([0.05, 0.03, 0.08]), np.array([0.2, 0.1, 0.06])
_PLACED = 'pos=".01 0 .02" quat=".95 .2 -.2 .1"'
XML = f"""
<mujoco><worldbody>
  <geom name="ground" type="plane" size="0 0 1" {_PLACED}/><geom name="hole" type="sphere" size="1e-3" {_PLACED}/>
  <geom name="edge" type="sphere" size="1e-3" {_PLACED}/>
  <geom name="pipe" type="cylinder" size=".1 .1" {_PLACED}/>
  <body pos="0 0 .1"><freejoint/>
    <geom name="peg" type="cylinder" size=".045 .09" mass="1" pos=".01 0 0" quat=".9 .1 .2 0"/></body>
  <body pos="0 0 .1"><freejoint/><geom name="block" type="box" size=".05 .03 .08" mass="1" quat=".8 .1 0 .3"/></body>
  <body pos="0 0 .1"><freejoint/><geom name="anvil" type="box" size=".2 .1 .06" mass="3"/></body>
</worldbody></mujoco>"""
FORMS = {"hole": Solid.hole(*HOLE), "edge": Solid.edge(*EDGE)}
PAIRS = [(tool, thing) for tool in ("peg", "block") for thing in ("ground", "hole", "edge", "pipe", "anvil")]


@dataclass(frozen=True)
class Placed:
    """One geom where it is."""

    x: Vector
    R: Vector

    def world(self, local: Vector) -> Vector:
        return self.x + self.R @ local

    def local(self, point: Vector) -> Vector:
        return self.R.T @ (point - self.x)


SOLIDS: dict[str, Callable[[Vector], twin.Found]] = {
    "hole": lambda p: twin.hole(p, *HOLE),
    "edge": lambda p: twin.edge(p, *EDGE),
    "peg": lambda p: twin.cylinder(p, *PEG),
    "block": lambda p: twin.box(p, BLOCK),
}


def own_points(tool: str) -> tuple[list[Vector], float]:
    """Of a tool, in its axes, and the share of each."""
    if tool == "block":
        return twin.corners(BLOCK), 0.25
    return twin.rim(PEG[0], PEG[1], RIM) + twin.rim(PEG[0], -PEG[1], RIM), 1.0 / RIM


def deepest_on_line(tool: str, at: Placed, place: Vector, along: Vector) -> Vector:
    """By sampling, ever finer: the middle of the places that are as deep."""
    middle, width = float((at.x - place) @ along), 0.4
    for _ in range(9):
        steps = middle + np.linspace(-width, width, 201)
        values = np.array([SOLIDS[tool](at.local(place + t * along))[0] for t in steps])
        middle, width = float(steps[values <= values.min() + 1e-13].mean()), 0.05 * width
    return place + middle * along


def points_of_other(thing: str, tool: str, at: Placed, other: Placed) -> list[tuple[Vector, float, float]]:
    """World place, radius and share of what the other presses with."""
    if thing == "hole":
        radius, _, chamfer = HOLE
        both = twin.rim(radius + chamfer, 0.0, RIM) + twin.rim(radius, -chamfer, RIM)
        return [(other.world(p), 0.0, 1.0 / RIM) for p in both]
    if thing == "anvil":
        return [(other.world(p), 0.0, 0.25) for p in twin.corners(ANVIL)]
    if thing != "edge":
        return []
    angle, rounding = EDGE
    tip = np.linalg.solve(np.array([[0.0, 1.0], [np.sin(angle), -np.cos(angle)]]), [-rounding, -rounding])
    return [(deepest_on_line(tool, at, other.world(np.array([0.0, *tip])), other.R[:, 0]), rounding, 1.0)]


def touches(
    model: mujoco.MjModel, data: mujoco.MjData, tool: str, thing: str
) -> list[tuple[Vector, Vector, float, float]]:
    """Point, normal towards the tool, depth and share of every contact point."""
    at = Placed(data.geom(tool).xpos, data.geom(tool).xmat.reshape(3, 3))
    other = Placed(data.geom(thing).xpos, data.geom(thing).xmat.reshape(3, 3))
    points, share = own_points(tool)
    found = []
    for p in (at.world(local) for local in points):
        if thing in FORMS:
            distance, n = SOLIDS[thing](other.local(p))
            n = other.R @ n
            found.append((p - 0.5 * distance * n, n, -distance, share))
        else:
            geom = model.geom(thing)
            found.append((*touch_ball(p, 0.0, geom.type[0], geom.size, other.x, other.R, thing == "pipe"), share))
    for p, radius, part in points_of_other(thing, tool, at, other):
        distance, n = SOLIDS[tool](at.local(p))
        into = -at.R @ n
        found.append((p + 0.5 * (radius + distance) * into, into, radius - distance, part))
    return found


@pytest.fixture(scope="module")
def scene() -> tuple[mujoco.MjModel, mujoco.MjData, ContactLoop, list[tuple[int, int]]]:
    model = mujoco.MjModel.from_xml_string(XML)
    model.geom_contype[:] = 0
    data = mujoco.MjData(model)
    loop = ContactLoop(model, data, *half_steps())
    slots = [
        loop.add_pair(model.geom(a).id, model.geom(b).id, MATERIAL, b == "pipe", FORMS.get(b), tool=True)
        for a, b in PAIRS
    ]
    return model, data, loop, slots


Scene = tuple[mujoco.MjModel, mujoco.MjData, ContactLoop, list[tuple[int, int]]]


@settings(max_examples=25)
@given(seed=st.integers(0, 2**31))
def test_every_point_of_a_tool_equals_the_twins_and_the_whole_is_their_sum(scene: Scene, seed: int) -> None:
    model, data, loop, slots = scene
    rng = np.random.default_rng(seed)
    randomise(model, data, rng)
    n = loop.slots
    bristles = np.zeros((n, BRISTLE_SIZE))
    bristles[:, :3] = rng.standard_normal((n, 3)) * 1e-5
    bristles[:, 3:] = np.column_stack([rng.uniform(0.3, 0.5, n), rng.integers(0, 2, n)])
    before, force, point, depth = bristles.copy(), np.zeros((n, 3)), np.zeros((n, 3)), np.zeros(n)
    assert loop.evaluate(DT, np.zeros((model.nbody, 6)), bristles, force, point, depth)
    total = {tool: np.zeros(6) for tool in ("peg", "block", "anvil")}
    for (tool, thing), (first, count) in zip(PAIRS, slots, strict=True):
        found = touches(model, data, tool, thing)
        assert len(found) == count
        for slot, (p, normal, d, share) in enumerate(found, first):
            body, other = model.geom(tool).bodyid[0], model.geom(thing).bodyid[0]
            v = point_velocity(model, data, body, p) - point_velocity(model, data, other, p)
            scaled = MATERIAL * np.array([share, share, 1.0, 1.0, 1.0, 1.0, share, share])
            f, after = force_of(scaled, normal, d, v, before[slot], DT)
            flat = thing == "edge" and slot == first + count - 1  # where the line lies along a face, any place is right
            assert depth[slot] == pytest.approx(d, abs=1e-9)
            if flat and not np.allclose(point[slot], p, atol=1e-5):
                continue
            assert np.allclose(point[slot], p, atol=2e-6)
            scale = max(1.0, float(np.abs(f).max()))
            assert np.allclose(force[slot], f, rtol=1e-4, atol=2e-6 * scale)
            assert np.allclose(bristles[slot], after, rtol=1e-5, atol=1e-9)
        for name, sign in ((tool, 1.0), (thing, -1.0)):
            if name in total:
                levers = point[first : first + count] - data.xipos[model.geom(name).bodyid[0]]
                mine = sign * force[first : first + count]
                total[name] += np.concatenate([mine.sum(axis=0), np.cross(levers, mine).sum(axis=0)])
    for name, wrench in total.items():
        pushed = data.xfrc_applied[model.geom(name).bodyid[0]]
        assert np.allclose(pushed, wrench, rtol=1e-9, atol=1e-9 * max(1.0, float(np.abs(wrench).max())))


def test_every_pair_touched_with_points_of_both(scene: Scene) -> None:
    """The comparison above would prove nothing about points that never meet."""
    model, data, loop, slots = scene
    n = loop.slots
    met, depth = np.zeros(n, dtype=bool), np.zeros(n)
    for seed in range(60):
        randomise(model, data, np.random.default_rng(seed))
        loop.evaluate(DT, np.zeros((model.nbody, 6)), np.zeros((n, 5)), np.zeros((n, 3)), np.zeros((n, 3)), depth)
        met |= depth > 0.0
    for (tool, _), (first, count) in zip(PAIRS, slots, strict=True):
        own = len(own_points(tool)[0])
        assert met[first : first + own].all()
        assert count == own or met[first + own : first + count].any()


@pytest.mark.parametrize("name", ["hole", "edge"])
def test_the_distance_of_a_solid_equals_the_twins(name: str) -> None:
    rng = np.random.default_rng(1)
    points = rng.uniform(-0.12, 0.12, (3000, 3))
    distance, place, normal = FORMS[name].nearest(points)
    for i, p in enumerate(points):
        d, n = SOLIDS[name](p)
        assert distance[i] == pytest.approx(d, abs=1e-12)
        assert np.allclose(normal[i], n, atol=1e-9)
        assert np.allclose(place[i], p - d * n, atol=1e-9)
