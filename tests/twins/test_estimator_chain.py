"""The compiled chain of estimators against its twin in Python, measurement by measurement."""

from __future__ import annotations

import copy
import dataclasses
import pickle
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

from pliant.errors import RobotError, SignalError
from pliant.estimation import (
    Butterworth,
    CarriedMass,
    DirectEstimator,
    EnvironmentEstimator,
    ExternalTorqueEstimator,
    FilteredEstimator,
    FirstOrder,
    FitConfig,
    JointAcceleration,
    JointStateFilter,
    MomentumObserver,
    Tare,
    WrenchEstimator,
)
from pliant.interfaces import Estimator
from pliant.robot import Robot
from pliant.signals import Estimate, Measurement
from pliant.surfaces import SphereSurface
from tests.twins.estimator_chain.environment import EnvironmentTwin
from tests.twins.estimator_chain.filtered import FilteredTwin
from tests.twins.estimator_chain.filters import ButterworthTwin, FirstOrderTwin
from tests.twins.estimator_chain.joint_state import JointStateTwin
from tests.twins.estimator_chain.momentum_observer import MomentumTwin
from tests.twins.estimator_chain.wrench import WrenchTwin

CLOSE = 1e-10
PERIOD = 1e-3
LOAD = CarriedMass(0.8, (0.01, -0.02, 0.05), (1.0, -2.0, 0.5, 0.1, 0.0, -0.1), (2e-3, 3e-3, 1e-3, 1e-4, 0.0, 2e-4))
ROBOT = Robot.load("iiwa14").with_frame("tool", "flange", (0.01, 0.02, 0.1))
LEG = Robot.load("leg3")


def readings(robot: Robot, sensor: str, count: int = 400, still: int = 0) -> list[Measurement]:
    """A robot that swings and presses now and then; at rest in the first `still` readings."""
    rng, n, made = np.random.default_rng(3), robot.n, []
    amplitude, phase = rng.uniform(0.05, 0.3, n), rng.uniform(0.0, 6.0, n)
    for k in range(count):
        t, s = k * PERIOD, max(0, k - still) * PERIOD
        q = robot.home + amplitude * (np.sin(7.0 * s + phase) - np.sin(phase)) + 1e-4 * rng.normal(size=n)
        v = (7.0 * amplitude * np.cos(7.0 * s + phase) if k > still else np.zeros(n)) + 1e-3 * rng.normal(size=n)
        press = 30.0 * max(0.0, np.sin(25.0 * s)) if k > still else 0.0
        wrench = np.array([0.3, -0.2, -1.0, 0.01, 0.02, 0.0]) * press + 0.05 * rng.normal(size=6)
        made.append(Measurement(t, q, v, rng.normal(0.0, 9.0, n), rng.normal(0.0, 9.0, n), {sensor: wrench}))
    return made


def estimates(estimator: Estimator[Any], measurements: list[Measurement]) -> list[Estimate]:
    state, found = estimator.init(measurements[0]), []
    for measurement in measurements:
        estimate, state = estimator.step(measurement, state)
        found.append(estimate)
    return found


def off(a: Estimate, b: Estimate) -> float:
    """Largest difference, as a share of the size of the values where that is above one."""
    assert a.time == b.time
    assert dict(a.contacts) == dict(b.contacts)
    assert tuple(a.wrenches) == tuple(b.wrenches)
    assert tuple(a.environments) == tuple(b.environments)
    pairs = [(getattr(a, name), getattr(b, name)) for name in ("q", "v", "torque", "torque_sent")]
    pairs += [(a.wrenches[frame], b.wrenches[frame]) for frame in b.wrenches]
    assert (a.disturbance is None) == (b.disturbance is None)
    if a.disturbance is not None:
        pairs.append((a.disturbance, b.disturbance))
    for frame, known in b.environments.items():
        found = a.environments[frame]
        assert np.isinf(found.damping_std) == np.isinf(known.damping_std)
        numbers = [(e.stiffness, e.damping, e.stiffness_std) for e in (found, known)]
        pairs.append((np.array(numbers[0]), np.array(numbers[1])))
    return max(float((np.abs(x - y) / np.maximum(1.0, np.abs(y))).max()) for x, y in pairs)


def worst(compiled: Estimator[Any], twin: Estimator[Any], measurements: list[Measurement]) -> float:
    here, there = estimates(compiled, measurements), estimates(twin, measurements)
    return max(off(a, b) for a, b in zip(here, there, strict=True))


@pytest.mark.parametrize(("robot", "sensor"), [(ROBOT, "flange"), (LEG, "foot")])
@pytest.mark.parametrize("carried", [None, LOAD])
@pytest.mark.parametrize("tare", [None, Tare(0.02, "weight"), Tare(0.05, "bias")])
def test_wrenches(robot: Robot, sensor: str, carried: CarriedMass | None, tare: Tare | None) -> None:
    beyond = {"flange": "tool"} if robot is ROBOT else {}
    options: dict[str, Any] = {"velocity_gain": 0.4, "contact_frames": beyond, "tare": tare}
    options["acceleration"] = JointAcceleration(120.0)
    loads = {sensor: carried} if carried else {}
    here, there = WrenchEstimator(robot, loads, **options), WrenchTwin(robot, loads, **options)
    measurements = readings(robot, sensor, still=80)
    assert worst(here, there, measurements) < CLOSE
    found = [tuple(e.contacts.values()) for e in estimates(here, measurements)]
    assert len(set(found)) == 2 or (carried and not tare)  # it touches and lifts, unless a weight hangs there
    known = carried or CarriedMass()
    heavier = {sensor: dataclasses.replace(known, mass=known.mass + 1e-6, inertia=LOAD.inertia)}
    other = WrenchTwin(robot, heavier, **options)  # baseline: a milligram is noticed
    pairs = zip(estimates(here, measurements), estimates(other, measurements), strict=True)
    assert max(np.abs(a.wrenches[f] - b.wrenches[f]).max() for a, b in pairs for f in a.wrenches) > CLOSE


def chains(filtered: bool, normal: Any, contact: Any, compensation: Any, late: int) -> tuple[Any, Any]:
    """A whole chain and its twin."""
    here: Estimator[Any] = WrenchEstimator(ROBOT, {"flange": LOAD}, contact_frames={"flange": "tool"})
    there: Estimator[Any] = WrenchTwin(ROBOT, {"flange": LOAD}, contact_frames={"flange": "tool"})
    if filtered:
        here = FilteredEstimator(
            here, velocity=FirstOrder(60.0, PERIOD), torque=Butterworth(90.0, PERIOD), wrench=Butterworth(40.0, PERIOD)
        )
        there = FilteredTwin(
            there,
            velocity=FirstOrderTwin(60.0, PERIOD),
            torque=ButterworthTwin(90.0, PERIOD),
            wrench=ButterworthTwin(40.0, PERIOD),
        )
    here, there = JointStateFilter(here, 0.2), JointStateTwin(there, 0.2)
    fit = FitConfig(least_samples=10, accuracy=1e6, noise_depth=1e-7, drift=0.5 if filtered else 0.0)
    limits = {"sliding": 2.0, "reach": 1e-3 if filtered else None}
    here = EnvironmentEstimator(here, ROBOT, "tool", PERIOD, normal=normal, config=fit, **limits)
    there = EnvironmentTwin(there, ROBOT, "tool", PERIOD, normal=normal, config=fit, **limits)
    options: dict[str, Any] = {"contact": contact, "normal": normal, "compensation": compensation}
    options["late_readings"] = late
    return MomentumObserver(here, ROBOT, **options), MomentumTwin(there, ROBOT, **options)


@pytest.mark.parametrize("filtered", [False, True])
@pytest.mark.parametrize(
    ("normal", "contact", "compensation", "late"),
    [
        ((0.1, -0.2, 1.0), "normal", "none", 0),
        (SphereSurface(np.array([0.6, 0.0, -0.3]), np.eye(3), 0.5), "normal", "gravity", 2),
        ((0.0, 0.0, 1.0), "all", "gravity+coriolis", 1),
        ((0.0, 0.0, 1.0), "none", "none", 3),
    ],
)
def test_a_whole_chain(filtered: bool, normal: Any, contact: Any, compensation: Any, late: int) -> None:
    here, there = chains(filtered, normal, contact, compensation, late)
    measurements = readings(ROBOT, "flange")
    assert worst(here, there, measurements) < CLOSE
    found = estimates(here, measurements)
    assert any(estimate.environments for estimate in found)
    _, other = chains(filtered, normal, contact, compensation, late + 1)  # baseline: one period is noticed
    assert worst(here, other, measurements) > 1e-3


def test_somebody_elses_estimator_is_completed() -> None:
    """A Python part inside: its estimates go through the same stages."""
    measurements = readings(ROBOT, "flange")
    here = MomentumObserver(JointStateFilter(ExternalTorqueEstimator(WrenchEstimator(ROBOT), ROBOT, PERIOD)), ROBOT)
    there = MomentumTwin(JointStateTwin(ExternalTorqueEstimator(WrenchTwin(ROBOT), ROBOT, PERIOD)), ROBOT)
    assert worst(here, there, measurements) < CLOSE
    assert isinstance(here.init(measurements[0]).completed, type(there.init(measurements[0]).inner.inner))
    outside = ExternalTorqueEstimator(here, ROBOT, PERIOD)
    assert worst(outside, ExternalTorqueEstimator(there, ROBOT, PERIOD), measurements) < CLOSE


def test_branches_and_sliding_joints_are_those_of_pinocchio() -> None:
    """p, Cᵀv and g of any tree: an observer of a robot that nothing disturbs but what the torques leave unexplained."""
    model = pin.buildSampleModelHumanoidRandom()
    model = pin.buildReducedModel(model, [1], pin.neutral(model))  # a fixed base
    other = pin.Model()
    rng = np.random.default_rng(5)
    kinds = [pin.JointModelRX(), pin.JointModelPZ(), pin.JointModelRY(), pin.JointModelPX(), pin.JointModelRZ()]
    for index, kind in enumerate(kinds):
        placement = pin.SE3.Random()
        joint = other.addJoint(max(0, index - 2) if index == 4 else index, kind, placement, f"joint{index}")
        other.appendBodyToJoint(joint, pin.Inertia.Random(), pin.SE3.Random())
    other.armature = rng.uniform(0.01, 0.3, other.nv)
    for tree in (model, other):
        robot = Robot("tree", tree, None, pin.neutral(tree))
        made = [
            Measurement(k * PERIOD, rng.normal(size=tree.nv), rng.normal(size=tree.nv), *rng.normal(size=(2, tree.nv)))
            for k in range(20)
        ]
        for compensation in ("none", "gravity", "gravity+coriolis"):
            options: dict[str, Any] = {"compensation": compensation}
            assert (
                worst(
                    MomentumObserver(DirectEstimator(), robot, **options),
                    MomentumTwin(DirectEstimator(), robot, **options),
                    made,
                )
                < CLOSE
            )


def test_a_state_goes_in_and_another_comes_out() -> None:
    """The state that goes in stays as it is; copied and pickled it gives the same."""
    here, _ = chains(True, (0.0, 0.0, 1.0), "normal", "none", 2)
    measurements = readings(ROBOT, "flange", 60)
    state = here.init(measurements[0])
    for measurement in measurements[:50]:
        _, state = here.step(measurement, state)
    before = state.memory.copy()
    first, _ = here.step(measurements[50], state)
    np.testing.assert_array_equal(state.memory, before)
    for other in (state, copy.deepcopy(state), pickle.loads(pickle.dumps(state))):
        again, _ = here.step(measurements[50], other)
        assert off(first, again) == 0.0
    later, _ = here.step(measurements[51], state)
    assert off(later, here.step(measurements[51], here.init(measurements[0]))[0]) > 0.0  # baseline: it remembers


def test_what_does_not_fit_is_named() -> None:
    estimator = JointStateFilter(WrenchEstimator(ROBOT))
    first, second = readings(ROBOT, "flange", 2)
    state = estimator.init(second)
    with pytest.raises(SignalError, match=r"in order, got t = 0.0 s after 0.001 s"):
        estimator.step(first, state)
    with pytest.raises(RobotError, match="no frame 'foot'"):
        estimator.init(readings(LEG, "foot", 1)[0])
    with pytest.raises(ValueError, match="frame 'flange', which the first one had"):
        estimator.step(Measurement(0.1, *[np.zeros(ROBOT.n)] * 4, {"other": np.zeros(6)}), state)
    moving = WrenchEstimator(ROBOT, tare=Tare())
    with pytest.raises(SignalError, match="tared only at rest: a joint moves at"):
        estimates(moving, readings(ROBOT, "flange", 3))
