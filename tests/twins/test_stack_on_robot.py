"""The stack's step on a robot against the same core with pinocchio's kinematics."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

from pliant import _impedance
from pliant.axis_modes import AxisModes
from pliant.controllers.passivity_account import AccountSettings
from pliant.rigid_body import tree_of
from pliant.robot import Robot
from pliant.signals import Estimate, ImpedanceTuning, TaskReference
from pliant.spatial import Array, exp3

FRAMES = ["flange", "elbow"]
MODES = ("motion", "free", "motion", "motion", "motion", "free")


def core(robot: Robot) -> _impedance.Stack:
    return _impedance.Stack(
        "capped",
        1e-3,
        0.1,
        0.01,
        0.05,
        0.05,
        AccountSettings().numbers(1e-3),
        robot.torque_limit,
        [
            (6, "exponential", 1e-3, 1e-2, [True] * robot.n),
            (3, "tanh", 1e-3, 1e-2, [True] * 4 + [False] * (robot.n - 4)),
        ],
    )


def estimate_at(robot: Robot, q: Array) -> Estimate:
    zero = np.zeros(robot.n)
    return Estimate(0.0, q, zero, zero, zero)


def targets_near(robot: Robot, rng: np.random.Generator, tick: int) -> tuple[TaskReference, TaskReference]:
    """References 1 cm off; now and then without a rotation, with turned axes, or with arrays that are views."""
    made: list[TaskReference] = []
    for frame in FRAMES:
        position, rotation = robot.placement(robot.home, frame)
        wide = np.empty((3, 2))
        wide[:, 0] = position + 0.01 * rng.normal(size=3)
        turned = exp3(0.05 * rng.normal(size=3)) @ rotation
        made.append(TaskReference(frame, wide[:, 0], None if tick % 50 > 40 else turned.T.copy().T))
    if 100 <= tick < 200:
        made[0] = replace(made[0], modes=AxisModes(MODES, exp3(np.array([0.1, 0.2, 0.3]))))
    return made[0], made[1]


def test_it_equals_the_core_with_kinematics_of_pinocchio(iiwa14: Robot) -> None:
    rng, n, model = np.random.default_rng(3), iiwa14.n, iiwa14.model
    stack, data = core(iiwa14), model.createData()
    arm = _impedance.Arm(tree_of(model), FRAMES)
    memories = [np.zeros(stack.state_size) for _ in range(2)]
    outs = [np.zeros(stack.output_size) for _ in range(2)]
    tunings = [np.repeat([600.0, 30.0, 0.1, 0.03], k) for k in (6, 3)]
    q = iiwa14.home.copy()
    for tick in range(300):
        q = q + 1e-4 * rng.normal(size=n)
        targets = targets_near(iiwa14, rng, tick)
        retune = tuple(enumerate(tunings)) if tick == 0 else None
        bias = rng.normal(size=n) if tick % 2 else None
        assert stack.step_on(arm, memories[0], outs[0], estimate_at(iiwa14, q), targets, None, bias, retune) == 0
        pin.computeJointJacobians(model, data, q)
        poses = [pin.updateFramePlacement(model, data, iiwa14.frame_id(frame)) for frame in FRAMES]
        actual = tuple(part for pose in poses for part in (pose.translation.copy(), pose.rotation.copy()))
        desired = tuple(part for target in targets for part in (target.position.copy(), target.rotation))
        axes = tuple(None if target.modes is None else target.modes.rotation for target in targets)
        assert stack.step(memories[1], outs[1], q, data.J, actual, desired, bias, retune, axes) == 0
        np.testing.assert_allclose(outs[0], outs[1], rtol=0.0, atol=1e-10)
    assert np.abs(outs[0][:n]).max() > 1.0  # it works against something
    swapped = stack.step_on(
        _impedance.Arm(tree_of(model), FRAMES[::-1]),
        memories[0],
        outs[0],
        estimate_at(iiwa14, q),
        targets,
        None,
        None,
        None,
    )
    assert swapped == 0
    assert np.abs(outs[0][:n] - outs[1][:n]).max() > 0.1  # the control: other frames, other torques


def test_what_is_no_number_or_does_not_fit_is_told(iiwa14: Robot) -> None:
    stack, rng = core(iiwa14), np.random.default_rng(5)
    arm, targets = _impedance.Arm(tree_of(iiwa14.model), FRAMES), targets_near(iiwa14, rng, 0)
    memory, out, here = np.zeros(stack.state_size), np.zeros(stack.output_size), estimate_at(iiwa14, iiwa14.home)

    def code(estimate: Estimate = here, targets: tuple[TaskReference, ...] = targets) -> int:
        return stack.step_on(arm, memory, out, estimate, targets, None, None, None)

    assert code(estimate_at(iiwa14, np.full(iiwa14.n, np.nan))) == 1
    assert code(targets=(targets[0], replace(targets[1], position=np.full(3, np.inf)))) == 201
    assert code(targets=(replace(targets[0], rotation=np.full((3, 3), np.nan)), targets[1])) == 200
    assert not memory.any()  # nothing was changed
    with pytest.raises(ValueError, match="targets must have 2 entries, got 1"):
        code(targets=targets[:1])
    with pytest.raises(ValueError, match="q must have shape"):
        code(estimate_at(iiwa14, np.zeros(3)))
    with pytest.raises(ValueError, match=r"a rotation must have shape \(3, 3\), got \(2, 2\)"):
        code(targets=(replace(targets[0], rotation=np.eye(2)), targets[1]))
    with pytest.raises(ValueError, match="no frame 'hand'"):
        _impedance.Arm(tree_of(iiwa14.model), ["hand"])
    assert code(targets=(replace(targets[0], position=np.array([1, 0, 1])), targets[1])) == 0  # integers are numbers


def test_a_reference_that_is_not_as_it_was_seen_is_told(iiwa14: Robot) -> None:
    stack, rng = core(iiwa14), np.random.default_rng(5)
    arm, targets = _impedance.Arm(tree_of(iiwa14.model), FRAMES), targets_near(iiwa14, rng, 150)
    memory, out, here = np.zeros(stack.state_size), np.zeros(stack.output_size), estimate_at(iiwa14, iiwa14.home)
    seen = tuple((target.tuning, target.modes, target.rotation is None) for target in targets)

    def code(*others: TaskReference) -> int:
        return stack.step_on(arm, memory, out, here, others, seen, None, None)

    assert code(*targets) == 0  # the control
    kept = memory.copy()
    one, two = targets
    tuning = ImpedanceTuning(np.full(6, 100.0), np.full(6, 10.0), np.full(6, 0.2))
    assert one.modes is not None
    same_modes = AxisModes(one.modes.modes, one.modes.rotation)
    others = [
        (one,),
        (two, one),
        (one, two, two),
        (replace(one, tuning=tuning), two),
        (one, replace(two, rotation=None)),
    ]
    others += [(replace(one, modes=same_modes), two), (replace(one, frame="hand"), two)]
    assert [code(*other) for other in others] == [-1] * len(others)
    np.testing.assert_array_equal(memory, kept)
