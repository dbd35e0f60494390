"""Laws of trajectories: rates are derivatives, paths start from rest where they should, composition is exact."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pliant.errors import ConfigError, PliantError
from pliant.references.trajectories.shapes import circle, lemniscate, sine_line
from pliant.references.trajectories.spline import Spline
from pliant.references.trajectories.time_scaling import EaseIn, Scale
from pliant.references.trajectories.trajectory import Blend, Chain, Hold, Sum, Trajectory, Warped
from pliant.references.trajectories.waypoints import Waypoints, wrench_steps

H = 1e-5  # s


def smooth_trajectories() -> dict[str, Trajectory]:
    times = np.linspace(0.0, 5.0, 40)
    return {
        "lemniscate": lemniscate(),
        "line": sine_line(),
        "circle": circle((0.5, 0.1, 0.2), 0.07, 3.0),
        "eased": lemniscate().eased(2.0),
        "scaled": Warped(sine_line(), Scale(1.7)),
        "sum": Sum((lemniscate(), sine_line())),
        "blend": Blend(Hold((0.1, 0.2, 0.3)), lemniscate(), 1.5),
        "waypoints": Waypoints((0.0, 1.0, 3.0), [[0, 0, 0], [1, 2, 3], [-1, 0, 1]]),
        "spline": Spline(times, np.column_stack([np.sin(times), np.cos(2 * times), times])),
        "chain": Chain((Waypoints((0.0, 1.0), [[0, 0, 0], [0, -0.6, 0.5]]), lemniscate().eased(1.0))),
    }


@pytest.mark.parametrize("name", smooth_trajectories())
@settings(max_examples=25, deadline=None)
@given(time=st.floats(0.01, 4.9))
def test_rates_are_derivatives(name: str, time: float) -> None:
    trajectory = smooth_trajectories()[name]
    before, here, after = (trajectory.at(t) for t in (time - H, time, time + H))
    np.testing.assert_allclose(here.rate, (after.value - before.value) / (2 * H), atol=2e-6)
    # where a piece of a spline or a chain begins, the second derivative has a kink: tolerance = third derivative · step
    np.testing.assert_allclose(here.acceleration, (after.rate - before.rate) / (2 * H), atol=2e-3)


def test_lemniscate_is_the_papers() -> None:
    T, t = 4.0, 0.37
    expected = [0.1 * math.sin(4 * math.pi * t / T), -0.6, 0.5 + 0.2 * math.sin(2 * math.pi * t / T)]
    np.testing.assert_allclose(lemniscate(T).at(t).value, expected, atol=1e-15)
    speeds = [np.linalg.norm(lemniscate(T).at(s).rate) for s in np.linspace(0, T, 400)]
    assert max(speeds) == pytest.approx(0.444, abs=0.001)


def test_line_has_the_peak_speed_and_the_amplitude() -> None:
    points = [sine_line().at(s) for s in np.linspace(0, 10, 4001)]
    assert max(abs(p.value[0]) for p in points) == pytest.approx(0.5, abs=1e-5)
    assert max(np.linalg.norm(p.rate) for p in points) == pytest.approx(0.7, abs=1e-5)


def test_circle_starts_where_contact_was_made() -> None:
    R, w, t = 0.07, 3.0, 0.31
    expected = [0.5 + R * (1 - math.cos(w * t)), 0.1 - R * math.sin(w * t), 0.2]
    np.testing.assert_allclose(circle((0.5, 0.1, 0.2), R, w).at(t).value, expected, atol=1e-15)
    np.testing.assert_allclose(circle((0.5, 0.1, 0.2), R, w).at(0.0).value, (0.5, 0.1, 0.2), atol=1e-15)


def test_eased_path_starts_at_rest_and_stays_on_the_path() -> None:
    plain, eased = lemniscate(), lemniscate().eased(2.0)
    assert np.linalg.norm(plain.at(0.0).rate) > 0.3  # baseline: without easing it starts at full speed
    start = eased.at(0.0)
    np.testing.assert_array_equal(start.value, plain.at(0.0).value)
    assert not start.rate.any()
    assert not start.acceleration.any()
    for t in (2.0, 3.3, 7.0):  # afterwards it is the same motion, one second late
        for a, b in zip(eased.at(t), plain.at(t - 1.0), strict=True):
            np.testing.assert_allclose(a, b, atol=1e-12)


@given(seconds=st.floats(0.1, 5.0), phase=st.floats(0.0, 10.0))
def test_warp_inverts(seconds: float, phase: float) -> None:
    for warp in (EaseIn(seconds), Scale(seconds)):
        assert warp.at(warp.time_of(phase))[0] == pytest.approx(phase, abs=1e-6)


def test_blend_begins_as_the_first_and_ends_as_the_second() -> None:
    blend = Blend(Hold((0.1, 0.2, 0.3)), lemniscate(), 1.5)
    np.testing.assert_array_equal(blend.at(0.0).value, (0.1, 0.2, 0.3))
    assert not blend.at(0.0).rate.any()
    for a, b in zip(blend.at(1.5 - 1e-9), lemniscate().at(1.5), strict=True):
        np.testing.assert_allclose(a, b, atol=1e-6)


def test_spline_meets_its_samples_and_converges_with_fourth_order() -> None:
    def worst(count: int) -> float:
        times = np.linspace(0.0, 3.0, count)
        spline = Spline(times, np.sin(2 * times)[:, None])
        return max(abs(spline.at(t).value[0] - math.sin(2 * t)) for t in np.linspace(0, 2.999, 701))

    assert worst(21) / worst(41) > 12.0  # 16 in the limit
    times = np.array([0.0, 0.1, 0.35, 0.5, 1.0])
    values = np.array([[0.0], [1.0], [-1.0], [2.0], [0.5]])
    spline = Spline(times, values)
    np.testing.assert_allclose([spline.at(t).value for t in times], values, atol=1e-12)
    assert not spline.at(2.0).rate.any()


def test_cubic_is_reproduced() -> None:
    times = np.array([0.0, 0.2, 0.5, 0.9, 1.0])
    spline = Spline(times, (1 - times + 2 * times**2 - 3 * times**3)[:, None])
    point = spline.at(0.7)
    assert point.value[0] == pytest.approx(1 - 0.7 + 2 * 0.49 - 3 * 0.343, abs=1e-12)
    assert point.rate[0] == pytest.approx(-1 + 4 * 0.7 - 9 * 0.49, abs=1e-11)
    assert point.acceleration[0] == pytest.approx(4 - 18 * 0.7, abs=1e-10)


def test_wrench_steps_and_ramps() -> None:
    steps = wrench_steps((0.0, 1.0, 2.0), (40.0, 80.0, 20.0))
    assert [steps.at(t).value[2] for t in (0.0, 0.999, 1.0, 5.0)] == [40.0, 40.0, 80.0, 20.0]
    ramp = wrench_steps((1.0, 3.0), (5.0, 50.0), axis=(0, 0, -2), shape="ramp")
    assert ramp.at(2.0).value[2] == pytest.approx(-27.5)
    assert ramp.at(2.0).rate[2] == pytest.approx(-22.5)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: lemniscate(period=0.0), "period"),
        (lambda: sine_line(amplitude=-1.0), "amplitude"),
        (lambda: circle((0, 0, 0), 0.1, 1.0, (1, 0, 0), (1, 1, 0)), "perpendicular"),
        (lambda: Hold((0.0, float("nan"))), "finite"),
        (lambda: Waypoints((0.0, 0.0), [[1.0], [2.0]]), "increase"),
        (lambda: Waypoints((0.0, 1.0), [[1.0], [2.0]], "jump"), "valid: step, ramp, smooth"),
        (lambda: Sum((Hold((0.0,)), Hold((0.0, 1.0)))), "one size"),
        (lambda: Chain((lemniscate(), Hold((0, 0, 0)))), "never ends"),
        (lambda: Chain((Waypoints((0.0, 1.0), [[0, 0, 0], [1, 0, 0]]), Hold((0, 0, 0)))), "do not meet"),
        (lambda: EaseIn(-1.0), "0 s or more"),
        (lambda: Scale(0.0), "above zero"),
    ],
)
def test_bad_input_is_named(make: object, words: str) -> None:
    with pytest.raises(PliantError, match=words):
        make()  # type: ignore[operator]


def test_errors_are_config_errors() -> None:
    with pytest.raises(ConfigError):
        wrench_steps((0.0,), (1.0,), axis=(0, 0, 0))
