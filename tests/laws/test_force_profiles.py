"""Force profiles: odd, continuous, monotone, bounded, and the derivative of their energy."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pliant.controllers.profiles import ForceProfile, Shape
from pliant.errors import ConfigError
from pliant.signals import ImpedanceTuning
from tests.laws.impedance_strategies import profile_of, profiles


def grid(profile: ForceProfile, points: int = 4001) -> np.ndarray:
    return np.linspace(0.0, 1.5 * float(profile.range[0]), points)[:, None]


def slope_bound(profile: ForceProfile) -> float:
    """Steepest slope of a profile, N/m: its linear part or its bend."""
    rise = float(profile.force_max[0] - profile.knee_force[0])
    share = 1.0 if profile.shape is Shape.EXPONENTIAL else 1.0 / (1.0 + np.tanh(np.pi))
    return max(float(profile.stiffness[0]), share * rise / float(profile.length[0]))


@given(profiles(), st.floats(0.0, 1.5))
def test_force_is_the_derivative_of_energy(profile: ForceProfile, share: float) -> None:
    step = 1e-4 * float(np.minimum(profile.length[0], profile.range[0]))
    a = np.array([share * profile.range[0] + 2 * step])
    difference = (profile.energy(a + step) - profile.energy(a - step)) / (2 * step)
    rounding = 4e-16 * float(profile.energy(a)[0]) / step
    # A central difference across the knee is off by at most half the jump of the slope times the step.
    tolerance = slope_bound(profile) * step + 10 * rounding
    assert difference == pytest.approx(profile.force(a), abs=tolerance)


@given(profiles())
def test_force_is_odd_monotone_and_bounded(profile: ForceProfile) -> None:
    a = grid(profile)
    force = profile.force(a)
    assert np.array_equal(profile.force(-a), -force)
    assert np.all(np.diff(force, axis=0) >= -1e-12 * profile.force_max)
    assert np.all(np.abs(force) <= profile.force_max * (1 + 1e-12))


@given(profiles())
def test_force_is_continuous_at_the_knee(profile: ForceProfile) -> None:
    step = 1e-9 * float(profile.range[0])
    below, above = profile.force(profile.linear_range - step), profile.force(profile.linear_range + step)
    assert float(np.abs(above - below)[0]) <= 3 * slope_bound(profile) * step + 1e-12 * float(profile.force_max[0])


def test_the_tanh_profile_without_its_shift_jumps_at_the_knee() -> None:
    """Baseline: F_0 + ½ ΔF (tanh z + 1) starts 0.2 % of ΔF too high."""
    profile = profile_of(1000.0, 150.0, 0.025, shape=Shape.TANH)
    z = (profile.linear_range - profile.range) / profile.length + np.pi
    rise = profile.force_max - profile.knee_force
    jump = 0.5 * rise * (np.tanh(z) + 1.0)
    assert float((jump / rise)[0]) == pytest.approx(0.0019, abs=2e-4)
    assert float(profile.force(profile.linear_range + 1e-12)[0] - profile.knee_force[0]) < 1e-6


# ---------------------------------------------------------------------- the profiles as they are printed

PRINTED = {
    Shape.EXPONENTIAL_PRINTED: profile_of(5000.0, 150.0, 0.006, 0.005, Shape.EXPONENTIAL_PRINTED),
    Shape.TANH_PRINTED: profile_of(6000.0, 300.0, 0.025, shape=Shape.TANH_PRINTED),
}


@pytest.mark.parametrize("profile", PRINTED.values(), ids=list(PRINTED))
def test_a_printed_profile_is_odd_monotone_and_bounded_and_the_slope_of_its_energy(profile: ForceProfile) -> None:
    a = grid(profile)
    force, step = profile.force(a), 1e-9
    assert np.array_equal(profile.force(-a), -force)
    assert np.all(np.diff(force, axis=0) >= 0.0)
    assert float(force.max()) <= float(profile.force_max[0])
    smooth = np.abs(a - profile.linear_range) > 2 * step
    smooth &= np.abs(a - profile.range) > 2 * step
    slope = (profile.energy(a + step) - profile.energy(a - step)) / (2 * step)
    np.testing.assert_allclose(slope[smooth], force[smooth], atol=1e-4 * float(profile.force_max[0]))
    total = np.sum(0.5 * (force[1:] + force[:-1]) * np.diff(a, axis=0))
    assert float(profile.energy(a[-1])[0]) == pytest.approx(float(total), rel=1e-3)


def test_the_printed_exponential_jumps_where_it_should_have_saturated() -> None:
    """Table I's end-effector: F_0 = 25 N, 26 N just before x_b = 6 mm, and there 150 N at once; with the factor ΔF (the
    control) it is continuous."""
    printed, mended = PRINTED[Shape.EXPONENTIAL_PRINTED], profile_of(5000.0, 150.0, 0.006, 0.005)
    before, after = np.array([0.006 - 1e-9]), np.array([0.006])
    assert float(printed.force(before)[0]) == pytest.approx(26.0, abs=1e-3)
    assert float(printed.force(after)[0]) == 150.0
    assert float(mended.force(before)[0]) == pytest.approx(150.0, abs=1e-3)


def test_the_printed_tanh_jumps_where_its_linear_part_ends() -> None:
    """F_0 = 0.95 · 6000 · 0.025 = 142.5 N, and ½ ΔF (tanh(π − 0.05/S) + 1) more at once; the shifted one (the control)
    is continuous. Values of eq. 4, worked out here."""
    printed, mended = PRINTED[Shape.TANH_PRINTED], profile_of(6000.0, 300.0, 0.025, shape=Shape.TANH)
    knee = 0.95 * 0.025
    rise = 300.0 - 142.5
    jump = 0.5 * rise * (np.tanh(np.pi - 0.05 / 0.1353) + 1.0)
    assert jump == pytest.approx(156.9, abs=0.1)
    for profile, expected in ((printed, jump), (mended, 0.0)):
        step = float(profile.force([knee + 1e-12])[0] - profile.force([knee])[0])
        assert step == pytest.approx(expected, abs=1e-3)
    at_range = 142.5 + 0.5 * rise * (np.tanh(np.pi) + 1.0)
    assert float(printed.force([0.025])[0]) == pytest.approx(at_range)


def test_a_printed_tanh_whose_linear_part_passes_its_bound_is_refused() -> None:
    with pytest.raises(ConfigError, match=r"F_max must be at least 0\.95 K_0 x_b = 142\.5, got 100"):
        profile_of(6000.0, 100.0, 0.025, shape=Shape.TANH_PRINTED)


@pytest.mark.parametrize("shape", [Shape.EXPONENTIAL, Shape.TANH, Shape.EXPONENTIAL_PRINTED])
def test_force_max_is_reached_at_the_range(shape: Shape) -> None:
    profile = profile_of(2500.0, 100.0, 0.06, 0.03, shape)
    assert float(profile.force([0.06])[0]) == pytest.approx(100.0, rel=2e-3)


def test_the_linear_part_ends_at_95_percent_where_it_is_not_given() -> None:
    assert profile_of(1000.0, 150.0, 0.025).linear_range == pytest.approx([0.95 * 0.025])
    assert profile_of(6000.0, 90.0, 0.025).linear_range == pytest.approx([0.95 * 90.0 / 6000.0])


def test_an_axis_that_is_off_gives_nothing() -> None:
    profile = profile_of(0.0, 0.0, 0.0)
    assert profile.force([3.0]) == pytest.approx([0.0])
    assert profile.energy([3.0]) == pytest.approx([0.0])


@pytest.mark.parametrize(
    ("numbers", "rule"),
    [
        ((5000.0, 10.0, 0.02, 0.01), r"F_max = 10 < 5000 · 0\.01 = 50"),
        ((5000.0, 100.0, 0.01, 0.01), r"x_b = 0\.01, x_0 = 0\.01"),
        ((0.0, 100.0, 0.02, 0.01), r"stiffness 0 needs force_max 0"),
        ((-1.0, 100.0, 0.02, 0.01), r"must not be negative, got \[-1\.0\]"),
    ],
)
def test_impossible_tunings_are_refused_with_their_numbers(numbers: tuple[float, ...], rule: str) -> None:
    with pytest.raises(ConfigError, match=rule):
        ImpedanceTuning(*(np.array([number]) for number in numbers))
