"""The fractal attractor: bounded, continuous, passive under any switching in continuous time, and it comes home."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pliant.controllers.attractor import Law, converging_force
from pliant.controllers.phase_settings import PhaseSettings
from pliant.controllers.profiles import ForceProfile, Shape
from tests.laws.impedance_strategies import profile_of, profiles, run_mass

SATURATING = profile_of(2500.0, 100.0, 0.06, 0.03)
STIFFENING = profile_of(1000.0, 150.0, 0.025, shape=Shape.TANH)
shares = st.floats(0.01, 0.99)


def back(law: Law, profile: ForceProfile, share: np.ndarray | float, x_m: float) -> np.ndarray:
    share = np.atleast_1d(np.asarray(share, dtype=np.float64))[:, None]
    return converging_force(law, profile, share * x_m, np.full_like(share, x_m))[:, 0]


# ------------------------------------------------------------------ bounds and continuity


@given(profiles(), st.floats(0.01, 3.0), st.sampled_from([-1.0, 1.0]))
def test_capped_force_is_odd_and_within_the_profile_and_force_max(
    profile: ForceProfile, reach: float, sign: float
) -> None:
    x_m = sign * reach * float(profile.range[0])
    share = np.linspace(0.0, 1.0, 401)
    h = back(Law.CAPPED, profile, share, x_m)
    peak = float(profile.magnitude(np.array([abs(x_m)]))[0])
    assert np.all(np.abs(h) <= peak * (1 + 1e-12))
    assert peak <= float(profile.force_max[0]) * (1 + 1e-12)
    inward = np.copysign(1.0, x_m) * h
    assert np.all(inward <= profile.magnitude(np.abs(share[:, None] * x_m))[:, 0] * (1 + 1e-12))
    assert inward + inward[::-1] == pytest.approx(np.zeros(401), abs=1e-9 * peak)  # −h at the mirrored place


def test_the_corrected_stack_law_exceeds_force_max() -> None:
    """Baseline: [Stack] Algorithm 1 past saturation."""
    assert back(Law.STACK_CORRECTED, SATURATING, 0.999, 0.2)[0] > 1.5 * SATURATING.force_max[0]


@given(profiles(), st.floats(0.01, 3.0))
def test_capped_force_is_continuous_where_convergence_starts(profile: ForceProfile, reach: float) -> None:
    x_m = reach * float(profile.range[0])
    before = float(profile.force([x_m])[0])
    after = back(Law.CAPPED, profile, 1.0 - 1e-9, x_m)[0]
    # On the way in the law falls at most with the slope 2 F(x_m)/x_m, or with the profile's own (length: of its bend).
    slope = max(2.0 * before / x_m, float(profile.stiffness[0]), float(profile.force_max[0] / profile.length[0]))
    assert abs(after - before) <= 2.0 * slope * x_m * 1e-9 + 1e-9 * before


@pytest.mark.parametrize("law", [Law.STACK_PRINTED, Law.STACK_CORRECTED])
def test_the_stack_paper_laws_jump_where_convergence_starts(law: Law) -> None:
    """Baseline."""
    assert abs(back(law, SATURATING, 1.0 - 1e-9, 0.1)[0] - float(SATURATING.force([0.1])[0])) > 50.0


# ------------------------------------------------------------------ passivity of the error port


def least_margin(law: Law, profile: ForceProfile, path: list[tuple[float, bool]]) -> float:
    """Least ∫h dx̃ − E(x̃) along a path of (error, whether to converge on the way there), as a share of the largest E.

    The phase may switch at every corner, however it likes; only a zero crossing and |x̃| ≥ |x_m| force divergence. Each
    piece is integrated by the midpoint rule in steps that resolve the bend.
    """
    x, x_m, absorbed, least, largest = 0.0, 0.0, 0.0, 0.0, 1e-12
    for corner, converge in path:
        steps = int(min(2000, max(100, 8 * abs(corner - x) / float(profile.length[0]))))
        converging = False
        for middle in x + (np.arange(steps) + 0.5) * (corner - x) / steps:
            if middle * x_m <= 0.0 or abs(middle) >= abs(x_m) or not converge:
                converging = False
                x_m = float(middle)
            else:
                converging = True
            h = back(law, profile, middle / x_m, x_m)[0] if converging else float(profile.force([middle])[0])
            absorbed += h * (corner - x) / steps
            energy = float(profile.energy([middle + 0.5 * (corner - x) / steps])[0])
            least, largest = min(least, absorbed - energy), max(largest, energy)
        x = corner
        if not converging:
            x_m = x
    return least / largest


@st.composite
def paths(draw: st.DrawFn, reach: float) -> list[tuple[float, bool]]:
    corners = draw(st.lists(st.tuples(st.floats(-2.0, 2.0), st.booleans()), min_size=1, max_size=5))
    return [(reach * corner, converge) for corner, converge in corners]


@given(st.data())
def test_capped_law_is_passive_for_any_switching(data: st.DataObject) -> None:
    profile = data.draw(profiles())
    path = data.draw(paths(float(profile.range[0])))
    assert least_margin(Law.CAPPED, profile, path) > -0.02  # what the midpoint rule leaves over at the knee


@pytest.mark.parametrize("profile", [SATURATING, STIFFENING])
def test_capped_law_is_passive_on_interrupted_convergence(profile: ForceProfile) -> None:
    for share in (0.9, 0.75, 0.5, 0.25):
        x_m = 1.5 * float(profile.range[0])
        assert least_margin(Law.CAPPED, profile, [(x_m, False), (share * x_m, True), (x_m, False)]) > -1e-3


@pytest.mark.parametrize(
    ("law", "profile", "share", "created"),
    [(Law.HAPFIC, STIFFENING, 0.5, 0.5), (Law.STACK_CORRECTED, SATURATING, 0.75, 0.08)],
)
def test_the_printed_laws_create_energy_on_interrupted_convergence(
    law: Law, profile: ForceProfile, share: float, created: float
) -> None:
    """Baseline of the test above: the same path, more than `created` of the stored energy out of nothing."""
    x_m = (4.0 if law is Law.STACK_CORRECTED else 1.05) * float(profile.range[0])
    assert least_margin(law, profile, [(x_m, False), (share * x_m, True)]) < -created
    assert least_margin(Law.CAPPED, profile, [(x_m, False), (share * x_m, True)]) > -1e-3


# ------------------------------------------------------------------ a sampled mass


def test_undamped_mass_settles_and_the_plain_spring_diverges() -> None:
    stiff = profile_of(15000.0, 150.0, 0.02, 0.007)
    capped = run_mass(stiff, start=0.002, seconds=3.0)
    spring = run_mass(stiff, start=0.002, seconds=3.0, law=Law.SPRING)
    assert np.abs(capped.error[-500:]).max() < 1e-4
    assert np.abs(spring.error[-500:]).max() > 0.02  # ten times where it started, and growing
    assert np.abs(spring.error[-500:]).max() > 1.2 * np.abs(spring.error[-1500:-1000]).max()


def test_the_printed_stack_law_never_settles() -> None:
    printed = run_mass(SATURATING, start=0.02, seconds=4.0, law=Law.STACK_PRINTED)
    capped = run_mass(SATURATING, start=0.02, seconds=4.0)
    assert np.abs(capped.error[-1000:]).max() < 2e-4
    assert np.abs(printed.error[-1000:]).max() > 0.01


def test_a_moving_target_is_followed_without_damping() -> None:
    run = run_mass(
        profile_of(15000.0, 150.0, 0.02, 0.007), start=0.0, seconds=6.0, target=lambda t: 0.1 * np.sin(3.0 * t)
    )
    assert np.abs(run.error[1000:]).max() < 2.5e-3  # m ẍ_d/K_0 = 0.1 mm, plus the damping's own lag


@pytest.mark.parametrize("damping", [0.0, 2.0, 20.0, 200.0, 2000.0])
@pytest.mark.parametrize("profile", [SATURATING, STIFFENING])
def test_no_damping_parks_it_halfway(profile: ForceProfile, damping: float) -> None:
    start = 0.8 * float(profile.range[0])
    slowest = damping / float(profile.stiffness[0])  # s, time constant of the overdamped way home
    run = run_mass(profile, start=start, damping=damping, seconds=2.0 + 12.0 * slowest)
    assert np.abs(run.error[-100:]).max() < 0.02 * start


def test_without_the_time_out_it_parks_halfway() -> None:
    """Baseline."""
    run = run_mass(SATURATING, start=0.05, damping=200.0, seconds=3.0, settings=PhaseSettings(hold_limit=1e9))
    assert 0.4 * 0.05 < np.abs(run.error[-1]) < 0.6 * 0.05


@pytest.mark.parametrize("damping", [0.0, 20.0, 200.0, 2000.0])
@pytest.mark.parametrize("load", [0.0, 40.0])
def test_force_never_stays_away_while_the_error_is_large(damping: float, load: float) -> None:
    run = run_mass(
        SATURATING, start=0.05, damping=damping, load=-load, seconds=3.0, target=lambda t: 0.03 * np.sin(2 * t)
    )
    large = np.abs(run.error) > 2e-3
    idle = large & (np.abs(run.force) < 0.01 * SATURATING.magnitude(np.abs(run.error)[:, None])[:, 0])
    idle &= np.abs(run.rate) < run.threshold
    longest = max((len(stretch) for stretch in "".join("x" if i else " " for i in idle).split()), default=0)
    assert longest <= 32  # ticks of 1 ms: the hold limit and the ticks at its ends


def pushes(t: float) -> float:
    """N: 0.3 s long, 0.2 s apart, in random directions."""
    strengths = np.random.default_rng(8).uniform(-60.0, 60.0, 20)
    return float(strengths[int(t / 0.5)]) if t % 0.5 < 0.3 else 0.0


def margin_under_pushes(profile: ForceProfile, blend_time: float, period: float, account: bool = True) -> np.ndarray:
    """∫h dx̃ − (E(x̃) − E(x̃_0)) at every tick, J."""
    settings = PhaseSettings(blend_time=blend_time)
    run = run_mass(profile, start=0.01, load=pushes, seconds=4.0, period=period, settings=settings, account=account)
    absorbed = np.concatenate([[0.0], np.cumsum(run.force[:-1] * np.diff(run.error))])
    energy = profile.energy(run.error[:, None])[:, 0]
    return absorbed - (energy - energy[0])


@pytest.mark.parametrize("profile", [SATURATING, STIFFENING])
@pytest.mark.parametrize("blend_time", [0.0, 0.008])
def test_the_whole_attractor_is_passive_under_pushes(profile: ForceProfile, blend_time: float) -> None:
    """Phase logic, law, blend and account together: ∫h dx̃ ≥ E(x̃) − E(x̃_0) but for less than 5 mJ."""
    for period in (1e-3, 2.5e-4):
        margin = margin_under_pushes(profile, blend_time, period)
        assert margin[-1] > 0.1  # J: it damps what the pushes bring in
        assert margin.min() > -5e-3


def test_a_blend_as_long_as_a_swing_creates_energy_unless_it_has_to_pay() -> None:
    assert margin_under_pushes(STIFFENING, 0.05, 1e-3).min() > -0.01
    assert margin_under_pushes(STIFFENING, 0.05, 1e-3, account=False).min() < -0.1  # baseline


def test_where_convergence_ends_the_force_does_not_jump() -> None:
    runs = {}
    for blend_time in (0.0, 0.008):
        settings = PhaseSettings(blend_time=blend_time)
        runs[blend_time] = run_mass(SATURATING, start=0.05, damping=40.0, load=pushes, seconds=4.0, settings=settings)
    steps = {blend_time: np.abs(np.diff(run.force)).max() for blend_time, run in runs.items()}
    # N: an eighth of the way from −F_max to F_max, K_0 v T_s, and what the account cannot pay for
    assert steps[0.008] < 2.0 * 100.0 / 8 + 2.5 + 5.0
    assert steps[0.0] > 40.0  # baseline


def test_noise_does_not_make_the_phase_chatter() -> None:
    noisy = {"start": 0.0, "load": -30.0, "damping": 15.0, "noise": 3e-5, "seconds": 3.0}
    adaptive = run_mass(SATURATING, **noisy)
    fixed = run_mass(SATURATING, **noisy, settings=PhaseSettings(noise_time=1e9))
    switches = [np.abs(np.diff(run.converging[1000:])).sum() / 2.0 for run in (adaptive, fixed)]
    assert switches[0] < 5.0  # per second
    assert switches[1] > 50.0


def test_the_threshold_is_three_standard_deviations_of_the_filtered_rate() -> None:
    run = run_mass(profile_of(0.0, 0.0, 0.0), start=0.01, noise=1e-4, seconds=3.0)
    assert np.median(run.threshold[1500:]) == pytest.approx(3.0 * np.std(run.rate[1500:]), rel=0.15)
