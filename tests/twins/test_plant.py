"""The compiled robot against Python: the imperfect chain against its twin, MuJoCo's period against the Python loop."""

from __future__ import annotations

import copy
import pickle
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pliant import _plant
from pliant.errors import RunFailedError
from pliant.robot import Robot
from pliant.signals import Command, Measurement
from pliant.simulation import ForceSensor, Imperfections, ImperfectPlant, JointEffects, MujocoPlant, Push, Scene, table
from pliant.simulation import mujoco_library as library
from pliant.simulation.imperfections.actuation import ActuationConfig
from pliant.simulation.imperfections.ripple import RippleConfig
from pliant.simulation.imperfections.sensing import SensingConfig
from pliant.simulation.imperfections.torque_loop import TorqueLoopConfig
from tests.twins.imperfect_robot.plant import ImperfectTwin

CLOSE = 1e-10
SIGNALS = ("q", "v", "torque", "torque_sent")


def off(a: Measurement, b: Measurement) -> float:
    """Largest difference of two readings, as a share of the size of the values where that is above one."""
    pairs = [(getattr(a, name), getattr(b, name)) for name in SIGNALS]
    pairs += [(a.wrenches[frame], b.wrenches[frame]) for frame in b.wrenches]
    assert tuple(a.wrenches) == tuple(b.wrenches)
    assert a.time == b.time
    return max(float((np.abs(x - y) / np.maximum(1.0, np.abs(y))).max()) for x, y in pairs)


def arm(python: bool = False, contact: Any = "mujoco", **options: Any) -> MujocoPlant:
    """A leg over a table that it presses, with a sensor that carries something."""
    robot = Robot.load("leg3")
    sensor = ForceSensor("foot", mass=0.3, center=(0.01, 0.0, 0.02), inertia=(1e-3, 2e-3, 3e-3, 1e-4, 0.0, 0.0))
    push = Push("foot", (3.0, -1.0, 2.0), 0.01, 0.02)
    height = float(MujocoPlant(robot, observe=["foot"]).truth(MujocoPlant(robot).init()[1]).positions["foot"][2])
    scene = Scene((table((0.0, 0.0, height - robot.contact_radius["foot"] + 1e-3)),), contact=contact)
    plant = MujocoPlant(robot, scene, sensors=[sensor], pushes=[push], observe=["foot"], **options)
    assert plant.compiled is not None
    if python:
        plant.compiled = None
    return plant


def torques(count: int) -> np.ndarray:
    return np.random.default_rng(4).normal(0.0, 4.0, (count, 3))


@pytest.mark.parametrize("contact", ["mujoco", "explicit"])
@pytest.mark.parametrize("compensation", ["none", "gravity+coriolis"])
def test_a_period_in_mujoco_equals_the_python_loop(compensation: Any, contact: Any) -> None:
    here, there = (arm(python, contact, joints=JointEffects(compensation=compensation)) for python in (False, True))
    (a, world), (b, twin) = here.init(), there.init()
    pressed = 0
    for k, torque in enumerate(torques(120)):
        if k == 50:
            for one in (world, twin):
                one.pushes.append(Push("foot", (0.0, 5.0, 0.0), 0.0, np.inf))
        a, world = here.step(Command(a.time, torque, np.zeros(3)), world)
        b, twin = there.step(Command(b.time, torque, np.zeros(3)), twin)
        assert off(a, b) < CLOSE
        assert world.touching == twin.touching
        assert np.allclose(world.wrenches["foot"], twin.wrenches["foot"], rtol=CLOSE, atol=CLOSE)
        pressed += bool(world.touching)
    assert pressed > 2


def driven(plant: MujocoPlant, world: Any) -> None:
    for _ in range(300):
        _, world = plant.step(Command(0.0, np.full(3, 30.0), np.zeros(3)), world)


@pytest.mark.parametrize("contact", ["mujoco", "explicit"])
def test_a_joint_that_is_too_fast_ends_both_in_the_same_words(contact: Any) -> None:
    said = []
    for python in (False, True):
        plant = arm(python, contact, speed_stop=0.5)
        _, world = plant.init()
        with pytest.raises(RunFailedError) as error:
            driven(plant, world)
        said.append(str(error.value))
    assert said[0] == said[1]
    assert "reached" in said[0]


CHAINS = st.builds(
    Imperfections,
    computation_delay=st.integers(0, 4).map(lambda k: 1e-3 * k),
    torque_loop=st.builds(
        TorqueLoopConfig, gain_p=st.floats(0, 0.5), gain_i=st.floats(0, 20), gain_d=st.floats(0, 1e-5)
    ),
    actuation=st.builds(
        ActuationConfig,
        gain=st.just((0.8, 1.2)),
        bias=st.just((-1.0, 1.0)),
        dry_friction=st.floats(0, 1),
        viscous_friction=st.tuples(*[st.floats(0, 1)] * 3),
        noise=st.sampled_from([0.0, 0.1, (0.0, 0.2, 0.0)]),
        bandwidth=st.sampled_from([None, 20.0, 300.0]),
        peak_torque=st.sampled_from([None, 8.0]),
    ),
    ripple=st.builds(RippleConfig, amplitude=st.floats(0, 5)),
    sensing=st.builds(
        SensingConfig,
        delay=st.integers(0, 3).map(lambda k: 1e-3 * k),
        delay_torque=st.sampled_from([None, 0.0, 2e-3]),
        delay_force=st.integers(0, 3).map(lambda k: 1e-3 * k),
        noise_q=st.sampled_from([0.0, 1e-3]),
        noise_v=st.sampled_from([0.0, 1e-3]),
        noise_torque=st.sampled_from([0.0, (0.0, 0.0, 0.1)]),
        noise_force=st.sampled_from([0.0, 0.1]),
        noise_moment=st.sampled_from([0.0, 0.01]),
        torque_gain_error=st.floats(0, 0.2),
        torque_offset=st.floats(0, 0.5),
    ),
)


@settings(max_examples=25, deadline=None)
@given(config=CHAINS, seed=st.integers(0, 99), ticks=st.sampled_from([1, 2]), python=st.booleans())
def test_the_chain_equals_its_twin(config: Imperfections, seed: int, ticks: int, python: bool) -> None:
    """Compiled round a compiled robot or round a Python one, against Python round the same robot."""
    options: dict[str, Any] = {"seed": seed, "period": 1e-3 * ticks}
    here = ImperfectPlant(ROBOT[python], config, **options)
    there = ImperfectTwin(ROBOT[True], config, **options)
    (a, world), (b, twin) = here.init(), there.init()
    assert off(a, b) < CLOSE
    for torque in torques(80):
        a, world = here.step(Command(a.time, torque, np.zeros(3)), world)
        b, twin = there.step(Command(b.time, torque, np.zeros(3)), twin)
        assert off(a, b) < 1e-7  # the two robots drift apart by what a contact makes of rounding


ROBOT = {python: arm(python, physics_step=5e-4, period=5e-4) for python in (False, True)}


def test_a_state_can_be_copied_and_pickled() -> None:
    plant = ImperfectPlant(arm(), Imperfections.p3(), seed=3)
    reading, world = plant.init()
    for torque in torques(70):
        reading, world = plant.step(Command(reading.time, torque, np.zeros(3)), world)
    worlds = [world, copy.deepcopy(world), pickle.loads(pickle.dumps(world))]
    logs = []
    for one in worlds:
        now, log = reading, []
        for torque in torques(20):
            now, one = plant.step(Command(now.time, torque, np.zeros(3)), one)
            log.append(np.concatenate([now.q, now.v, now.torque, now.wrenches["foot"]]))
        logs.append(np.array(log))
    assert np.array_equal(logs[0], logs[1])
    assert np.array_equal(logs[0], logs[2])


def test_another_mujoco_than_the_compiled_one_means_the_python_loop_and_a_sentence(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    assert library.mismatch() == ""
    monkeypatch.setattr(library._plant, "MUJOCO_VERSION", _plant.MUJOCO_VERSION - 1)
    library.can_look_inside.cache_clear()
    try:
        with pytest.warns(UserWarning, match="was compiled for MuJoCo .* and found .* reinstall pliant"):
            plant = MujocoPlant(Robot.load("leg3"))
        assert plant.compiled is None
        reading, world = plant.init()
        assert plant.step(Command(0.0, np.zeros(3), np.zeros(3)), world)[0].time > reading.time
    finally:
        monkeypatch.undo()
        library.can_look_inside.cache_clear()


def test_values_of_another_robot_are_refused() -> None:
    plant = arm()
    _, world = plant.init()
    assert plant.compiled is not None
    core, size = plant.compiled.core, plant.compiled.size
    with pytest.raises(ValueError, match="torque must have 3 entries"):
        core.step(world.data, np.zeros(4), [], np.zeros(size))
    with pytest.raises(ValueError, match="out must have"):
        core.step(world.data, np.zeros(3), [], np.zeros(size - 1))
    with pytest.raises(ValueError, match="frame_of_geom"):
        _plant.Physics(plant.model, library.addresses(library.FUNCTIONS), 1, False, [1.0], [1.0], [], [], [], [], [])


def test_contacts_of_another_robot_are_refused() -> None:
    plant = arm(contact="explicit")
    _, world = plant.init()
    assert plant.compiled is not None
    core, out = plant.compiled.core, np.zeros(plant.compiled.size)
    slots = np.zeros((len(world.contacts.force), 3))
    assert core.read(world.data, slots, slots, out) == 0  # baseline: nothing touches
    for force, point, name in ((slots[:0], slots, "force"), (slots, np.zeros((9, 3)), "point")):
        with pytest.raises(ValueError, match=f"{name} must have 3 entries"):
            core.read(world.data, force, point, out)
    with pytest.raises(ValueError, match="out must have"):
        core.hold(world.data, np.zeros(3), [], out[1:])
    with pytest.raises(ValueError, match="torque must have"):
        core.hold(world.data, np.zeros(2), [], out)
