"""The compiled impedance core against its Python twin, over random sequences of poses, targets and tunings."""

from __future__ import annotations

import numpy as np
import pytest

from pliant import _impedance
from pliant.controllers.attractor import Law
from pliant.controllers.energy_ledger import channel_table, layout_of
from pliant.controllers.passivity_account import AccountSettings
from pliant.controllers.phase_settings import PhaseSettings
from pliant.controllers.profiles import ForceProfile, Shape
from pliant.flat_channels import FlatChannels
from pliant.signals import ImpedanceTuning
from pliant.spatial import Array, exp3, log3
from tests.twins.impedance_twin import TwinTask, works

PERIOD = 1e-3
SETTINGS = PhaseSettings()
JOINTS = 9
MOVES = np.array([[True] * 6 + [False] * 3, [False] * 6 + [True] * 3])
"""(tasks, n) which joints move which frame"""


def core(law: Law, shapes: list[Shape], axes: list[int], limit: float = np.inf) -> _impedance.Stack:
    tasks = [
        (k, shape.value, SETTINGS.rate_floor, SETTINGS.rate_floor_angular, MOVES[i].tolist())
        for i, (k, shape) in enumerate(zip(axes, shapes, strict=True))
    ]
    gains = {"rate_gain": SETTINGS.rate_gain(PERIOD), "noise_gain": SETTINGS.noise_gain(PERIOD)}
    limits = np.full(JOINTS, limit)
    return _impedance.Stack(
        law=law.value,
        period=PERIOD,
        hold_limit=SETTINGS.hold_limit,
        blend_step=SETTINGS.blend_step(PERIOD),
        account=AccountSettings().numbers(PERIOD) if law is Law.CAPPED else None,
        torque_limit=limits,
        tasks=tasks,
        **gains,
    )


def packed(profile: ForceProfile) -> Array:
    return np.concatenate([profile.stiffness, profile.force_max, profile.range, profile.linear_range])


def random_tuning(rng: np.random.Generator, axes: int, shape: Shape = Shape.EXPONENTIAL) -> ImpedanceTuning:
    stiffness = 10.0 ** rng.uniform(1.0, 4.0, axes)
    reach = rng.uniform(0.01, 0.1, axes) if rng.random() < 0.7 else rng.uniform(0.1, 0.5, axes)
    if shape is Shape.TANH_PRINTED:  # its linear part ends at 0.95 x_b
        return ImpedanceTuning(stiffness, stiffness * reach * rng.uniform(0.95, 3.0, axes), reach)
    if rng.random() < 0.5:
        return ImpedanceTuning(stiffness, stiffness * reach * rng.uniform(0.05, 3.0, axes), reach)
    bend = reach * rng.uniform(0.0, 0.95, axes)
    return ImpedanceTuning(stiffness, stiffness * bend * rng.uniform(1.0, 3.0, axes) + 0.1, reach, bend)


def wander(rng: np.random.Generator, steps: int) -> Array:
    """(steps, 6) smooth random motion that turns often, m and rad, with noise now and then."""
    t = PERIOD * np.arange(steps)[:, None]
    amplitude, speed = rng.uniform(0.01, 0.15, (5, 6)), rng.uniform(1.0, 40.0, (5, 6))
    path = sum(a * np.sin(w * t + 6.0 * rng.random(6)) for a, w in zip(amplitude, speed, strict=True)) / 5.0
    return path + rng.choice([0.0, 0.0, 1e-5, 1e-4]) * rng.standard_normal((steps, 6))


def joints_of(poses: list[tuple[Array, Array]]) -> Array:
    """(6, 9) three slides and three hinges move the frame a, three slides the frame b."""
    J = np.zeros((6, JOINTS), order="F")
    J[:3, :3] = J[3:, 3:6] = J[:3, 6:] = np.eye(3)
    J[:3, 3:6] = np.cross(poses[0][0], np.eye(3)).T
    return J


def way_of(poses: list[tuple[Array, Array]], last: list[tuple[Array, Array]]) -> Array:
    """(9,) how far its joints moved."""
    turn = log3(poses[0][1] @ last[0][1].T)
    return np.concatenate([poses[0][0] - last[0][0], turn, poses[1][0] - last[1][0]])


@pytest.mark.parametrize("law", list(Law))
@pytest.mark.parametrize(("seed", "limit"), [(0, np.inf), (1, np.inf), (2, 20.0), (3, 5.0)])
def test_core_equals_its_twin(law: Law, seed: int, limit: float) -> None:
    rng = np.random.default_rng(100 + seed)
    pairs = ((Shape.EXPONENTIAL, Shape.TANH_PRINTED), (Shape.TANH, Shape.EXPONENTIAL_PRINTED))
    axes, shapes = [6, 3], list(pairs[seed % 2])
    stack = core(law, shapes, axes, limit)
    twins = [TwinTask(law, PERIOD, k, SETTINGS) for k in axes]
    table = channel_table(JOINTS, [("a", 6), ("b", 3)])
    memory, out = np.zeros(stack.state_size), np.full(stack.output_size, np.nan)
    steps = 250
    got: dict[str, list[object]] = {}
    wanted: dict[str, list[object]] = {}
    actual, desired = [wander(rng, steps) for _ in axes], [wander(rng, steps) for _ in axes]
    tunings = [random_tuning(rng, *each) for each in zip(axes, shapes, strict=True)]
    q, torques, kept_back = np.zeros(JOINTS), np.zeros((2, JOINTS)), np.zeros(JOINTS)
    last: list[tuple[Array, Array]] = []
    for step in range(steps):
        changed = [i for i in range(2) if step == 0 or rng.random() < 0.02]
        for i in changed:
            tunings[i] = random_tuning(rng, axes[i], shapes[i])
        forms = [ForceProfile.of(tuning, shape) for tuning, shape in zip(tunings, shapes, strict=True)]
        profiles = [forms[i] if i in changed else twins[i].profile for i in range(2)]
        poses = [(actual[i][step, :3], exp3(actual[i][step, 3:])) for i in range(2)]
        targets = [(desired[i][step, :3], exp3(desired[i][step, 3:])) for i in range(2)]
        retune = tuple((i, packed(forms[i])) for i in changed)
        way = way_of(poses, last or poses)
        q, J, last = q + way, joints_of(poses), poses
        out[:] = np.nan
        code = stack.step(memory, out, q, J, sum(poses, ()), sum(targets, ()), None, retune or None)
        assert code == 0
        assert np.isfinite(out).all()
        channels = FlatChannels(layout_of(table), out[2 * JOINTS :].copy())
        work = works(torques, kept_back, way)
        for i, (label, twin) in enumerate(zip("ab", twins, strict=True)):
            profile = profiles[i]
            assert profile is not None
            expected = twin.step(poses[i], targets[i], profile, work[i])
            for name, value in expected.items():
                got.setdefault(f"{label}/{name}", []).append(channels[f"{label}/{name}"])
                wanted.setdefault(f"{label}/{name}", []).append(value)
            wrench = np.asarray(expected["wrench"])
            moved = J[:3].T @ wrench[:3] + J[3:].T @ (wrench[3:] + np.cross(poses[i][0], wrench[:3]))
            torques[i] = np.where(MOVES[i], moved, 0.0)
        sent = np.clip(torques.sum(axis=0), -limit, limit)
        kept_back = torques.sum(axis=0) - sent
        got.setdefault("torque", []).append(out[:JOINTS].copy())
        wanted.setdefault("torque", []).append(sent)
    for name, values in wanted.items():
        scale = max(1.0, float(np.abs(values).max()))
        np.testing.assert_allclose(np.array(got[name]), np.array(values), rtol=0.0, atol=2e-9 * scale, err_msg=name)
    assert np.array(wanted["a/phase"]).any() == (law is not Law.SPRING)
    assert (np.abs(wanted["a/account"]).max() > 1e-3) == (law is Law.CAPPED)


def test_clamped_torque_and_its_energy() -> None:
    stack = core(Law.SPRING, [Shape.EXPONENTIAL], [3], limit=1.0)
    memory, out = np.zeros(stack.state_size), np.zeros(stack.output_size)
    J = np.zeros((6, JOINTS), order="F")
    J[0, 0] = 1.0
    tuning = (0, np.array([1000.0] * 3 + [50.0] * 3 + [0.1] * 3 + [0.05] * 3))
    energy = 0.0
    for step in range(5):
        q = np.zeros(JOINTS)
        q[0] = 0.01 * step
        stack.step(
            memory, out, q, J, (q[:3], None), (np.array([0.06, 0, 0]), None), None, (tuning,) if step == 0 else None
        )
        assert out[0] == 1.0
        assert out[2 * JOINTS + 5] == pytest.approx(energy)
        energy += out[JOINTS] * 0.01
    assert energy > 0.1


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"q": np.zeros(6)}, "q must have 9 entries, got 6"),
        ({"J": np.zeros((6, 9))}, "column-major"),
        ({"actual": (np.zeros(3),)}, "actual must have 2 entries, got 1"),
        ({"desired": (np.zeros(4), None)}, "a position must have 3 entries, got 4"),
        ({"bias": np.zeros(3)}, "bias must have 9 entries, got 3"),
        ({"retune": ((0, np.zeros(3)),)}, "a tuning must have 12 entries, got 3"),
        ({"retune": ((1, np.zeros(12)),)}, "there is no task 1"),
        ({"memory": np.zeros(3)}, "memory must have"),
        ({"out": np.zeros(3)}, "out must have"),
    ],
)
def test_wrong_sizes_are_refused(change: dict[str, object], message: str) -> None:
    stack = core(Law.CAPPED, [Shape.TANH], [3])
    arguments: dict[str, object] = {
        "memory": np.zeros(stack.state_size),
        "out": np.zeros(stack.output_size),
        "q": np.zeros(9),
        "J": np.zeros((6, 9), order="F"),
        "actual": (np.zeros(3), None),
        "desired": (np.zeros(3), None),
        "bias": None,
        "retune": None,
    }
    with pytest.raises(ValueError, match=message):
        stack.step(**(arguments | change))


@pytest.mark.parametrize(("place", "code"), [("q", 1), ("actual", 100), ("desired", 200)])
def test_what_is_not_finite_is_named_and_changes_nothing(place: str, code: int) -> None:
    stack = core(Law.CAPPED, [Shape.TANH], [3])
    memory, out = np.zeros(stack.state_size), np.full(stack.output_size, 7.0)
    q, pose, target = np.zeros(9), np.zeros(3), np.zeros(3)
    {"q": q, "actual": pose, "desired": target}[place][1] = np.nan
    assert stack.step(memory, out, q, np.zeros((6, 9), order="F"), (pose, None), (target, None), None, None) == code
    assert not memory.any()
    assert (out == 7.0).all()


def driven_in_axes(axes: list[Array | None], turned: Array, steps: int = 250) -> dict[str, Array]:
    """Channels of one 6-axis task over random motion. Args: axes: of each tick; turned: (3, 3) of the whole world."""
    rng = np.random.default_rng(7)
    stack = core(Law.CAPPED, [Shape.EXPONENTIAL], [6], 40.0)
    table = channel_table(JOINTS, [("a", 6)])
    memory, out = np.zeros(stack.state_size), np.zeros(stack.output_size)
    actual, desired, tuning = wander(rng, steps), wander(rng, steps), random_tuning(rng, 6)
    retune = ((0, packed(ForceProfile.of(tuning, Shape.EXPONENTIAL))),)
    found: dict[str, list[Array]] = {}
    q, last = np.zeros(JOINTS), None
    for step in range(steps):
        pose = (turned @ actual[step, :3], turned @ exp3(actual[step, 3:]))
        target = (turned @ desired[step, :3], turned @ exp3(desired[step, 3:]))
        J = np.zeros((6, JOINTS), order="F")
        J[:3, :3] = J[3:, 3:6] = turned
        J[:3, 3:6] = np.cross(pose[0], turned.T).T
        moved = np.zeros(6) if last is None else np.concatenate([pose[0] - last[0], log3(pose[1] @ last[1].T)])
        q[:3], q[3:6], last = q[:3] + turned.T @ moved[:3], q[3:6] + turned.T @ moved[3:], pose
        code = stack.step(memory, out, q, J, pose, target, None, retune if step == 0 else None, (axes[step],))
        assert code == 0
        for name, value in FlatChannels(layout_of(table), out[2 * JOINTS :].copy()).items():
            found.setdefault(name, []).append(np.array(value))
    return {name: np.array(values) for name, values in found.items()}


def test_axes_that_are_turned_with_the_world_give_the_same() -> None:
    """A law that is the same in every set of axes: turning world and axes together changes no torque of its joints."""
    R = exp3(np.array([0.4, -0.9, 1.3]))
    level, turned = driven_in_axes([None] * 250, np.eye(3)), driven_in_axes([R] * 250, R)
    for name, values in level.items():
        wanted = values
        if name.endswith("/wrench"):
            wanted = np.hstack([values[:, :3] @ R.T, values[:, 3:] @ R.T])
        np.testing.assert_allclose(turned[name], wanted, atol=1e-7 * max(1.0, np.abs(wanted).max()), err_msg=name)
    world = driven_in_axes([None] * 250, R)
    assert np.abs(world["a/force"] - level["a/force"]).max() > 1.0  # the control: axes of the world are others


def test_axes_that_turn_on_the_way_are_booked_as_a_change_of_the_tuning() -> None:
    R = exp3(np.array([0.4, -0.9, 1.3]))
    once = driven_in_axes([None] * 120 + [R] * 130, np.eye(3))
    never = driven_in_axes([None] * 250, np.eye(3))
    tuning = once["a/energy_tuning"].ravel()
    assert np.all(tuning[:120] == never["a/energy_tuning"].ravel()[:120])
    assert tuning[120] != tuning[119]
    assert np.all(tuning[120:] == tuning[120])
    for name, values in once.items():
        np.testing.assert_array_equal(values[:120], never[name][:120], err_msg=name)
    started = once["a/energy_stored"].ravel()[0] + once["a/energy_dissipated"].ravel()[0]
    assert np.isfinite(started)
    assert np.isfinite(np.concatenate([values.ravel() for values in once.values()])).all()
