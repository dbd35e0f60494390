"""What a sensor carries is taken out of its readings: weight, inertia, tare, and the way to the contact frame."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pinocchio as pin
import pytest

from pliant.errors import ConfigError, SignalError
from pliant.estimation import CarriedMass, JointAcceleration, Tare, WrenchEstimator, start_hints
from pliant.robot import Robot, Tool
from pliant.signals import Command, Estimate, Measurement
from pliant.simulation import ForceSensor, MujocoPlant
from tests.twins.estimator_chain import joint_acceleration
from tests.twins.estimator_chain.carried_mass import SensorMotion, reading

MASS, CENTER, INERTIA = 0.8, (0.015, -0.02, 0.07), (2e-3, 3e-3, 1e-3, 1e-4, -2e-4, 3e-4)  # kg, m, kg m²


def swing(robot: Robot, t: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """0.3 rad at 1 Hz in all joints, from rest: the amplitude rises over the first half second."""
    w, rise = 2.0 * np.pi, min(t / 0.5, 1.0)
    ease, rate, bend = rise**2 * (3 - 2 * rise), 12 * rise * (1 - rise), 24 * (1 - 2 * rise) if t < 0.5 else 0.0
    s, c = np.sin(w * t), np.cos(w * t)
    q, v, a = ease * s, rate * s + ease * w * c, bend * s + 2 * rate * w * c - ease * w**2 * s
    ones = 0.3 * np.ones(robot.n)
    return robot.home + q * ones, v * ones, a * ones


def swung(robot: Robot, estimator: WrenchEstimator, noise: float = 0.0, seconds: float = 1.2) -> list[Estimate]:
    """Estimates while computed torque swings the arm in free air."""
    sensor = ForceSensor("flange", MASS, CENTER, INERTIA)
    plant = MujocoPlant(robot, sensors=[sensor])
    measurement, world = plant.init()
    draw = np.random.default_rng(0)
    data, state, seen = robot.model.createData(), estimator.init(measurement), []
    for _ in range(round(seconds / plant.period)):
        blurred = measurement.v + noise * draw.standard_normal(robot.n)
        noisy = Measurement(
            measurement.time, measurement.q, blurred, measurement.torque, measurement.torque, measurement.wrenches
        )
        estimate, state = estimator.step(noisy, state)
        seen.append(estimate)
        q, v, a = swing(robot, measurement.time)
        wanted = a + 400.0 * (q - measurement.q) + 40.0 * (v - measurement.v)
        torque = pin.rnea(robot.model, data, measurement.q, measurement.v, wanted)
        measurement, world = plant.step(Command(0.0, np.array(torque), np.zeros(robot.n)), world)
    return seen


def rms_force(seen: list[Estimate]) -> float:
    forces = np.array([estimate.wrenches["flange"][:3] for estimate in seen])
    return float(np.sqrt(np.mean(np.sum(forces**2, axis=1))))


def test_a_carried_mass_in_free_motion_is_not_a_contact(iiwa14: Robot) -> None:
    known = swung(iiwa14, WrenchEstimator(iiwa14, {"flange": CarriedMass(MASS, CENTER, inertia=INERTIA)}))
    assert rms_force(known) < 1.0
    assert not any(estimate.contacts["flange"] for estimate in known)
    moments = np.array([estimate.wrenches["flange"][3:] for estimate in known])
    assert np.sqrt(np.mean(moments**2)) < 0.1
    # baseline: accelerations that come so late that only the weight goes
    late = JointAcceleration(cutoff=0.02)
    weight_only = swung(iiwa14, WrenchEstimator(iiwa14, {"flange": CarriedMass(MASS, CENTER)}, acceleration=late))
    assert rms_force(weight_only) > 4.0
    assert any(estimate.contacts["flange"] for estimate in weight_only)


def test_noise_on_the_velocities_is_not_a_contact_with_a_lower_cutoff(iiwa14: Robot) -> None:
    load, calm = {"flange": CarriedMass(MASS, CENTER, inertia=INERTIA)}, JointAcceleration(100.0)
    seen = swung(iiwa14, WrenchEstimator(iiwa14, load, acceleration=calm), noise=1e-3)
    assert rms_force(seen) < 1.0
    assert not any(estimate.contacts["flange"] for estimate in seen)


@pytest.mark.parametrize("cutoff", [30.0, 200.0])
def test_the_stated_error_of_joint_accelerations(cutoff: float) -> None:
    w, T = 2.0 * np.pi, 1e-3
    how, gain = JointAcceleration(cutoff), -np.expm1(-2 * np.pi * cutoff * T)
    t = np.arange(4000) * T
    state, out = joint_acceleration.init(0.0, np.array([w])), []
    for time in t:
        a, state = joint_acceleration.step(how, float(time), np.array([w * np.cos(w * time)]), state)
        out.append(a[0])
    error = np.array(out)[2000:] + w**2 * np.sin(w * t[2000:])
    stated = w * (2.0 * T * (1.0 - gain) / gain + T / 2)
    assert np.abs(error).max() / w**2 == pytest.approx(stated, rel=0.03)
    draws = np.random.default_rng(1).standard_normal(50000) * 1e-3
    state, out = joint_acceleration.init(0.0, np.zeros(1)), []
    for k, v in enumerate(draws):
        a, state = joint_acceleration.step(how, k * T, np.array([v]), state)
        out.append(a[0])
    assert np.std(out) == pytest.approx(1e-3 * np.sqrt(2 * gain**3 / (2 - gain) ** 3) / T, rel=0.03)


def test_what_a_load_reads_is_newton_and_euler() -> None:
    """Against pinocchio: the load as a free body that is moved with the same twist and acceleration."""
    random = np.random.default_rng(3)
    load = CarriedMass(MASS, CENTER, inertia=INERTIA)
    xx, yy, zz, xy, xz, yz = INERTIA
    inertia = pin.Inertia(MASS, np.array(CENTER), np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]))
    for _ in range(5):
        v, w, a, alpha = random.normal(size=(4, 3))
        spatial = pin.Motion(np.concatenate([a - np.cross(w, v), alpha]))  # of a classical acceleration a
        twist = pin.Motion(np.concatenate([v, w]))
        wrench = inertia * spatial + twist.cross(inertia * twist)
        np.testing.assert_allclose(reading(load, SensorMotion(a, w, alpha)), -wrench.vector, atol=1e-12)


def still(robot: Robot, reading: np.ndarray, tick: int = 0, speed: float = 0.0) -> Measurement:
    zero = np.zeros(robot.n)
    return Measurement(tick * 1e-3, np.array(robot.home), zero + speed, zero, zero, {"flange": reading})


def test_a_wrench_is_moved_to_the_contact_frame(iiwa14: Robot) -> None:
    robot = iiwa14.with_tool(Tool(length=0.2))
    R = robot.placement(robot.home, "flange")[1]
    force = np.array([3.0, -4.0, 12.0])  # N, world, at the tool's tip
    lever = robot.placement(robot.home, "tool")[0] - robot.placement(robot.home, "flange")[0]
    reading = np.concatenate([R.T @ force, R.T @ np.cross(lever, force)])
    moved = WrenchEstimator(robot, contact_frames={"flange": "tool"})
    m = still(robot, reading)
    estimate, _ = moved.step(m, moved.init(m))
    np.testing.assert_allclose(estimate.wrenches["tool"], [*force, 0.0, 0.0, 0.0], atol=1e-12)
    assert estimate.contacts["tool"]
    assert list(estimate.wrenches) == ["tool"]
    with pytest.raises(ConfigError, match="cannot feel what touches frame 'flange'"):
        WrenchEstimator(robot, contact_frames={"tool": "flange"})


@pytest.mark.parametrize(("kind", "after_turning"), [("weight", 0.0), ("bias", 1.0)])
def test_a_tare_takes_an_unknown_load(iiwa14: Robot, kind: str, after_turning: float) -> None:
    """0.5 kg that nobody named: gone after the tare; as a weight also when the wrist has turned, as an offset not."""
    estimator = WrenchEstimator(iiwa14, tare=Tare(kind=kind))  # type: ignore[arg-type]
    load = CarriedMass(0.5, (0.0, 0.0, 0.0))

    def reading(q: np.ndarray) -> np.ndarray:
        R = iiwa14.placement(q, "flange")[1]
        weight = R.T @ np.array([0.0, 0.0, -9.81 * load.mass])
        return np.concatenate([weight, np.zeros(3)])

    state = estimator.init(still(iiwa14, reading(iiwa14.home)))
    for tick in range(30):
        estimate, state = estimator.step(still(iiwa14, reading(iiwa14.home), tick), state)
        assert not estimate.contacts["flange"]
    assert np.linalg.norm(estimate.wrenches["flange"]) < 1e-9
    turned = np.array(iiwa14.home)
    turned[5] += 0.5
    zero = np.zeros(7)
    estimate, _ = estimator.step(Measurement(1.0, turned, zero, zero, zero, {"flange": reading(turned)}), state)
    left = np.linalg.norm(reading(turned) - reading(iiwa14.home))  # of an offset that has not turned with gravity
    assert left > 2.0
    size = np.linalg.norm(estimate.wrenches["flange"][:3])
    assert size == pytest.approx(after_turning * left, abs=1e-6)


def test_a_contact_after_the_tare_is_felt_and_a_moving_arm_is_not_tared(iiwa14: Robot) -> None:
    estimator = WrenchEstimator(iiwa14, tare=Tare())
    load, state = np.array([0.0, 0.0, 5.0, 0.0, 0.0, 0.0]), None
    for tick in range(40):
        m = still(iiwa14, load * (1.0 if tick < 30 else 3.0), tick)
        state = estimator.init(m) if state is None else state
        estimate, state = estimator.step(m, state)
    assert np.linalg.norm(estimate.wrenches["flange"][:3]) == pytest.approx(10.0)
    m = still(iiwa14, load, speed=0.3)
    with pytest.raises(SignalError, match=r"tared only at rest: a joint moves at 0\.3 rad/s"):
        estimator.step(m, estimator.init(m))
    refused: list[Callable[[], Tare]] = [lambda: Tare(duration=-1.0), lambda: Tare(kind="zero")]  # type: ignore[arg-type]
    for make in refused:
        with pytest.raises(ConfigError):
            make()


def test_a_load_that_nobody_named_is_hinted_at(iiwa14: Robot) -> None:
    estimator = WrenchEstimator(iiwa14)
    plant = MujocoPlant(iiwa14, sensors=[ForceSensor("flange", 0.5)])
    measurement, _ = plant.init()
    estimate, _ = estimator.step(measurement, estimator.init(measurement))
    (hint,) = start_hints(estimate)
    assert "contact of frame 'flange' is believed at t = 0 s, with 4.9 N" in hint
    assert "tare" in hint
    known = WrenchEstimator(iiwa14, {"flange": CarriedMass(0.5)})
    estimate, _ = known.step(measurement, known.init(measurement))
    assert start_hints(estimate) == ()
