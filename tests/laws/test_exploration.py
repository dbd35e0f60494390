"""Laws of the haptic exploration on a mass that touches a spring, each with the printed algorithm as baseline."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pliant.references.exploration.config import ExplorationConfig
from pliant.references.exploration.rules import AxisPhase
from tests.laws.one_axis import Log, World, run, tuning

PAPER = ExplorationConfig(mode="paper", reset=False)
FLOOR = {"stiffness": 1e6, "damping": 1e4}  # N/m, N s/m
BALL = {"stiffness": 1e3, "damping": 1e2}


def settled(log: Log, start: float, end: float, desired: float, band: float) -> float:
    """s from `start` until the force stays within ±band of the desired one."""
    part = (log.time >= start - 1e-9) & (log.time < end)
    bad = np.flatnonzero(np.abs(log.force[part] - desired) > band)
    return 0.0 if bad.size == 0 else float(log.time[part][bad[-1]] - start)


def late_rms(log: Log, desired: float, seconds: float = 0.5) -> float:
    late = log.time > log.time[-1] - seconds
    return float(np.sqrt(np.mean((log.force[late] - desired) ** 2)))


@pytest.fixture(scope="module")
def floor_log() -> Log:
    T = tuning()
    return run(World(x=0.001, **FLOOR), [(0, -0.002, 40, T), (0.6, -0.002, 80, T), (1.2, -0.002, 20, T)], 2.0)


def test_rigid_floor_is_reached_from_both_sides(floor_log: Log) -> None:
    assert settled(floor_log, 0.6, 1.2, 80, 2.0) < 0.10
    assert settled(floor_log, 1.2, 2.0, 20, 3.0) < 0.10


def test_no_limit_cycle_at_rest(floor_log: Log) -> None:
    assert late_rms(floor_log, 20, 0.2) < 0.01
    printed = run(World(x=0.001, **FLOOR), [(0, -0.002, 40, tuning())], 1.5, PAPER)
    assert late_rms(printed, 40) > 0.3


@pytest.mark.parametrize("mass", [0.8, 1.5])
def test_soft_ball_is_reached_from_both_sides(mass: float) -> None:
    T = tuning(6000, 150)
    events = [(0, -0.01, 15, T), (1.0, -0.01, 25, T), (2.0, -0.01, 8, T)]
    log = run(World(x=0.0, mass=mass, **BALL), events, 3.0)
    assert settled(log, 1.0, 2.0, 25, 0.5) < 0.25
    assert settled(log, 2.0, 3.0, 8, 0.85) < 0.25
    assert late_rms(log, 8) < 0.02
    fixed = ExplorationConfig(stiffness_floor=6000.0)  # baseline: without the stiffness estimate it crawls
    slow = run(World(x=0.0, mass=mass, **BALL), events, 3.0, fixed)
    assert settled(slow, 1.0, 2.0, 25, 0.5) > 0.4


def test_negative_force_is_the_mirror_image() -> None:
    T = tuning()
    up = run(World(x=0.001, **FLOOR), [(0, -0.002, 40, T)], 0.8)
    down = run(World(x=-0.001, side=-1.0, **FLOOR), [(0, 0.002, -40, T)], 0.8)
    np.testing.assert_allclose(down.force, -up.force, atol=1e-6)
    printed = run(World(x=-0.001, side=-1.0, **FLOOR), [(0, 0.002, -40, T)], 0.8, PAPER)
    assert late_rms(printed, -40) > 20.0  # baseline: runs the wrong way


@pytest.mark.parametrize("world", [BALL, {"stiffness": 2e4, "damping": 2e2}])
def test_same_trajectory_at_every_rate(world: dict[str, float]) -> None:
    """Settling of the force after a step, sampled at 0.5, 1 and 2 kHz."""

    def times(config: ExplorationConfig | None) -> list[float]:
        T = tuning(6000, 150)
        events = [(0, -0.01, 15, T), (0.8, -0.01, 25, T)]
        logs = [run(World(x=0.0, **world), events, 1.6, config, period) for period in (2e-3, 1e-3, 5e-4)]
        return [settled(log, 0.8, 1.6, 25, 1.5) for log in logs]

    ours = times(None)
    assert max(ours) - min(ours) < 0.04
    printed = times(PAPER)
    assert max(printed) > 1.6 * min(printed)  # a step per tick: four times the ticks, four times the speed


@settings(max_examples=10)
@given(
    stiffness=st.floats(2.5, 6.0).map(lambda x: 10.0**x),
    mass=st.floats(0.7, 2.5),
    F_d=st.floats(5.0, 60.0),
    K_0=st.sampled_from([3000.0, 6000.0, 12000.0]),
)
def test_any_stiffness_is_regulated_or_called_unreachable(stiffness, mass, F_d, K_0):
    damping = 0.1 * stiffness if stiffness < 1e4 else 0.01 * stiffness
    log = run(World(x=0.0, mass=mass, stiffness=stiffness, damping=damping), [(0, -0.01, F_d, tuning(K_0))], 2.0)
    assert np.all(np.abs(log.offset) <= 0.025)
    if log.unreachable[-1]:
        assert log.reachable[-1] < F_d
        assert log.offset[-1] == -0.025
        expected = (0.025 + 0.01) * stiffness * K_0 / (stiffness + K_0)
        assert log.reachable[-1] == pytest.approx(expected, rel=0.05)
    else:
        assert late_rms(log, F_d, 0.2) < 0.2 + 0.01 * F_d


def test_unreachable_force_is_said_and_left_behind() -> None:
    T = tuning()
    log = run(World(x=0.0, **BALL), [(0, -0.01, 60, T), (1.2, -0.01, 8, T)], 2.0)
    at = np.searchsorted(log.time, 1.19)
    assert log.unreachable[at] == 1.0
    assert log.offset[at] == -0.025
    assert log.reachable[at] == pytest.approx(0.035 * 1e3 * 12e3 / 13e3, rel=1e-3)  # (x_b + p) K_e K_0/(K_e + K_0)
    assert settled(log, 1.2, 2.0, 8, 0.1 * 52) < 0.3
    assert log.unreachable[-1] == 0.0


def test_nothing_moves_without_contact() -> None:
    """A leg held up by its shank: the foot feels nothing, so that the offset stays zero."""
    log = run(World(x=0.02, pushed=200.0, **FLOOR), [(0, -0.01, 40, tuning())], 0.5)
    assert not log.offset.any()
    assert set(log.phase) == {float(AxisPhase.FREE)}


def test_lost_contact_returns_or_holds() -> None:
    def lifted(config: ExplorationConfig) -> Log:
        T = tuning()
        return run(World(x=0.001, **FLOOR), [(0, -0.002, 40, T), (0.6, 0.03, 40, T)], 1.4, config)

    reset, hold = lifted(ExplorationConfig()), lifted(ExplorationConfig(reset=False))
    assert abs(reset.offset[-1]) < 1e-12
    assert abs(hold.offset[-1]) > 1e-3
    assert hold.phase[-1] == AxisPhase.FREE
    assert float(AxisPhase.LOST) in set(reset.phase)
    speed = np.abs(np.diff(reset.offset))[650:] / 1e-3
    assert np.max(speed) <= 0.1 + 1e-9  # slewed, not dropped


def test_seek_finds_a_surface_above_which_the_target_lies() -> None:
    T = tuning()
    found = run(World(x=0.012, **FLOOR), [(0, 0.01, 20, T)], 1.5, ExplorationConfig(seek=True))
    assert late_rms(found, 20) < 0.05
    missed = run(World(x=0.012, **FLOOR), [(0, 0.01, 20, T)], 1.5)
    assert not missed.force.any()


def test_printed_reset_fires_when_the_force_is_reached() -> None:
    """Baseline for the reset: printed, the offset drops to zero while regulating."""
    T = tuning()
    printed = run(World(x=0.0, **BALL), [(0, -0.01, 15, T)], 3.0, ExplorationConfig(mode="paper", reset=True))
    ours = run(World(x=0.0, **BALL), [(0, -0.01, 15, T)], 3.0)
    drops = np.abs(np.diff(printed.offset)) > 1e-3
    assert drops.any()
    assert np.max(np.abs(np.diff(ours.offset))) <= 0.15e-3 + 1e-9


def random_events(seed: int, count: int):
    """Changes of F_d, K_0, F_max, x_b, reset and target at 4 Hz, incompatible ones among them."""
    random = np.random.default_rng(seed)
    events = []
    for index in range(count):
        tuned = tuning(random.uniform(500, 12000), random.uniform(5, 300), random.uniform(0.002, 0.03))
        config = ExplorationConfig(reset=bool(random.integers(2)), seek=bool(random.integers(2)))
        events.append((0.25 * index, random.uniform(-0.02, 0.01), random.uniform(-80, 120), tuned, config))
    return events


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("world", [BALL, {"stiffness": 1e5, "damping": 5e2}])
def test_fifty_changes_online_never_break_a_bound(seed: int, world: dict[str, float]) -> None:
    events = random_events(seed, 50)
    log = run(World(x=0.005, drag=20.0, **world), events, 12.5, period=2e-3, dt=1e-4)
    bound = np.array([events[min(int(t / 0.25 + 1e-6), 49)][3].range[2] for t in log.time])
    force_max = np.array([events[min(int(t / 0.25 + 1e-6), 49)][3].force_max[2] for t in log.time])
    assert np.all(np.abs(log.offset) <= bound)
    assert np.all(np.abs(log.command) <= force_max * (1 + 1e-12))
    assert np.all(np.isfinite(log.x))
    assert np.max(np.abs(log.x)) < 0.2


def test_printed_algorithm_breaks_a_bound_that_shrinks() -> None:
    """Baseline: with the force reached it holds the offset, whatever the bound."""
    wide, narrow = tuning(6000, 150, 0.025), tuning(6000, 150, 0.002)
    soft = {"stiffness": 1e3, "damping": 1e2}
    events = [(0, -0.002, 15, wide), (2.5, -0.002, 0, narrow)]
    printed = run(World(x=0.0, **soft), events, 2.6, PAPER)
    ours = run(World(x=0.0, **soft), events, 2.6, ExplorationConfig(reset=False))
    assert np.max(np.abs(printed.offset[2502:])) > 0.002
    assert np.max(np.abs(ours.offset[2500:])) <= 0.002


@pytest.mark.parametrize("noise", [1.0])
def test_sensor_noise_of_one_newton(noise: float) -> None:
    log = run(World(x=0.001, **FLOOR), [(0, -0.002, 40, tuning())], 2.0, noise=noise)
    assert late_rms(log, 40, 1.0) < 0.25


def test_late_force_signal_stays_bounded() -> None:
    log = run(World(x=0.001, drag=20.0, **FLOOR), [(0, -0.002, 40, tuning())], 2.0, delay=5)
    assert late_rms(log, 40) < 0.5
