"""Laws of the harmonic planner, each with the printed attractor as baseline where it breaks the law."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pliant.references.planners import harmonic_attractor as attractor
from pliant.references.planners.superposition import MotionLimits, Superposition

LIMITS = MotionLimits(speed=0.3, acceleration=3.0)
POINT = st.tuples(*[st.floats(-0.5, 0.5)] * 3)
SEQUENCE = st.lists(st.tuples(st.floats(0.0, 1.5), POINT), min_size=1, max_size=6)
PERIOD = 1e-3  # s


def planned(start, sequence, step=0.025, tail=0.0):
    """Times, positions, velocities, accelerations of a plan that is retargeted on the way."""
    plan, time, rows = Superposition(tuple(start)), 0.0, []
    for wait, target in sequence:
        plan = plan.folded(time).retargeted(time, tuple(target), LIMITS)
        rows += [(t, *plan.at(t)) for t in np.arange(time, time + wait, step)]
        time += wait
    end = max(plan.end(), time)
    rows += [(t, *plan.at(t)) for t in np.append(np.arange(time, end, step), end + tail)]
    return [np.array(column) for column in zip(*rows, strict=True)]


def integrated(start, sequence, printed, seconds, speed=0.3):
    """Positions of the attractor's planner, integrated at 1 kHz."""
    settings_ = attractor.AttractorSettings(speed=speed, printed=printed)
    plan, rows, pending, due = attractor.start(tuple(start)), [], list(sequence), 0.0
    for tick in range(round(seconds / PERIOD)):
        while pending and tick * PERIOD >= due - 1e-9:
            wait, target = pending.pop(0)
            plan, due = attractor.retargeted(plan, tuple(target), settings_), due + wait
        plan = attractor.advanced(plan, PERIOD, settings_)
        rows.append([axis.position for axis in plan.axes])
    return np.array(rows)


def outside(points, corners):
    """Largest distance (m) by which points leave the hull of the corners, over many directions."""
    directions = np.random.default_rng(0).normal(size=(200, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    return float(np.max(points @ directions.T - np.max(np.asarray(corners) @ directions.T, axis=0)))


@settings(max_examples=30)
@given(start=POINT, sequence=SEQUENCE)
def test_stays_in_the_hull_of_start_and_targets(start, sequence):
    _, positions, _, _ = planned(start, sequence)
    assert outside(positions, [start, *[target for _, target in sequence]]) < 1e-12


@settings(max_examples=30)
@given(start=POINT, sequence=SEQUENCE)
def test_hull_at_each_instant_holds_only_the_targets_so_far(start, sequence):
    first = sequence[:1]
    _, positions, _, _ = planned(start, [(sequence[0][0], sequence[0][1])])
    assert outside(positions, [start, first[0][1]]) < 1e-12


def test_attractor_leaves_the_hull_when_retargeted():
    """Baseline: printed it runs away; corrected it overshoots by centimetres."""
    sequence = [(0.5, (0.4, 0.0, 0.0)), (3.0, (0.1, 0.0, 0.0))]
    corners = [(0.0, 0.0, 0.0), (0.4, 0.0, 0.0), (0.1, 0.0, 0.0)]
    random = np.random.default_rng(5)
    worst = 0.0
    for _ in range(5):
        targets = [(random.uniform(0.1, 1.0), tuple(random.uniform(-0.3, 0.3, 3))) for _ in range(4)]
        points = integrated((0.0, 0.0, 0.0), targets, printed=False, seconds=5.0)
        worst = max(worst, outside(points, [(0.0, 0.0, 0.0), *[t for _, t in targets]]))
    assert worst > 0.02
    assert outside(integrated((0.0, 0.0, 0.0), sequence, printed=True, seconds=3.0), corners) > 0.02


@settings(max_examples=30)
@given(start=POINT, sequence=SEQUENCE)
def test_rests_exactly_on_the_last_target(start, sequence):
    _, positions, velocities, _ = planned(start, sequence, tail=1.0)
    plan = Superposition(tuple(start))
    time = 0.0
    for wait, target in sequence:
        plan = plan.folded(time).retargeted(time, target, LIMITS)
        time += wait
    resting = plan.folded(plan.end() + 1.0)
    assert resting.at(plan.end() + 2.0).position == tuple(sequence[-1][1])
    np.testing.assert_allclose(positions[-1], sequence[-1][1], atol=1e-12)
    assert not velocities[-1].any()


@settings(max_examples=30)
@given(start=POINT, sequence=SEQUENCE, shift=POINT)
def test_mirror_and_translation(start, sequence, shift):
    _, plain, _, _ = planned(start, sequence)
    _, mirrored, _, _ = planned([-x for x in start], [(w, tuple(-x for x in t)) for w, t in sequence])
    moved_sequence = [(w, tuple(a + b for a, b in zip(t, shift, strict=True))) for w, t in sequence]
    _, moved, _, _ = planned([a + b for a, b in zip(start, shift, strict=True)], moved_sequence)
    np.testing.assert_allclose(mirrored, -plain, atol=1e-12)
    # durations may differ in the last bit: compare where both have samples
    count = min(len(moved), len(plain)) - 1
    np.testing.assert_allclose(moved[:count], plain[:count] + np.array(shift), atol=1e-6)


def test_printed_attractor_depends_on_origin_and_sign():
    """Baseline: the same step of 0.3 m, elsewhere and the other way round."""

    def travelled(start, target):
        return integrated((start, 0.0, 0.0), [(9.0, (target, 0.0, 0.0))], printed=True, seconds=4.0)[-1, 0] - start

    forth, moved, back = travelled(0.0, 0.3), travelled(1.0, 1.3), travelled(0.0, -0.3)
    assert max(abs(forth - moved), abs(forth + back), abs(forth - 0.3)) > 0.1


def test_corrected_attractor_reaches_a_single_target_on_a_straight_line():
    points = integrated((0.1, 0.2, 0.3), [(9.0, (0.4, 0.1, 0.1))], printed=False, seconds=4.0)
    np.testing.assert_allclose(points[-1], (0.4, 0.1, 0.1), atol=2e-3)
    way = np.array((0.3, -0.1, -0.2))
    across = np.cross(points - (0.1, 0.2, 0.3), way / np.linalg.norm(way))
    assert np.max(np.linalg.norm(across, axis=1)) < 1e-3
    assert np.max(np.linalg.norm(np.diff(points, axis=0), axis=1)) / PERIOD == pytest.approx(0.3, rel=0.02)


@settings(max_examples=30)
@given(start=POINT, sequence=SEQUENCE)
def test_summed_speed_and_acceleration_keep_their_limits(start, sequence):
    _, _, velocities, accelerations = planned(start, sequence, step=0.008)
    assert np.max(np.linalg.norm(velocities, axis=1)) <= 1.005 * LIMITS.speed
    assert np.max(np.linalg.norm(accelerations, axis=1)) <= 1.005 * LIMITS.acceleration


def test_without_stretching_the_sum_breaks_the_limit():
    """Baseline: two pieces of their own shortest time, one after half of the other."""
    duration = LIMITS.duration(0.4)
    first = Superposition((0.0, 0.0, 0.0)).retargeted(0.0, (0.4, 0.0, 0.0), LIMITS)
    naive = Superposition(
        first.base, (*first.pieces, first.pieces[0]._replace(start=0.5 * duration, target=(0.8, 0.0, 0.0)))
    )
    speeds = [math.hypot(*naive.at(t).velocity) for t in np.linspace(0, 1.5 * duration, 200)]
    assert max(speeds) > 1.2 * LIMITS.speed


@settings(max_examples=30)
@given(start=POINT, target=POINT)
def test_one_motion_is_a_straight_line_at_the_limit(start, target):
    distance = math.dist(start, target)
    if distance < 1e-3:
        return
    _, positions, velocities, accelerations = planned(start, [(0.0, target)], step=0.002)
    across = np.cross(positions - np.array(start), (np.array(target) - start) / distance)
    assert np.max(np.abs(across)) < 1e-12
    # a half cosine uses up one of its two limits
    used = np.max(np.linalg.norm(velocities, axis=1)) / LIMITS.speed
    pushed = np.max(np.linalg.norm(accelerations, axis=1)) / LIMITS.acceleration
    assert max(used, pushed) == pytest.approx(1.0, abs=0.01)


@settings(max_examples=30)
@given(start=POINT, sequence=SEQUENCE)
def test_velocity_and_acceleration_are_derivatives(start, sequence):
    plan, time = Superposition(tuple(start)), 0.0
    for wait, target in sequence:
        plan, time = plan.folded(time).retargeted(time, target, LIMITS), time + wait
    edges = [edge for p in plan.pieces for edge in (p.start, p.start + p.duration)]
    h = 1e-6
    for t in np.linspace(time, max(plan.end(), time) + 0.1, 17):
        if any(abs(t - edge) < 1e-4 for edge in edges):
            continue  # the acceleration jumps where a piece begins or ends
        low, mid, high = plan.at(t - h), plan.at(t), plan.at(t + h)
        np.testing.assert_allclose(mid.velocity, np.subtract(high.position, low.position) / (2 * h), atol=1e-7)
        np.testing.assert_allclose(mid.acceleration, np.subtract(high.velocity, low.velocity) / (2 * h), atol=1e-5)
