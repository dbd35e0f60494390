"""One fractal impedance: a mass that is pushed away from its target comes back without any damping.

A fractal impedance is a spring with two forces. While the error grows (divergence) the force follows a profile that
starts with the stiffness K_0 and bends towards F_max, which it never exceeds. On the way back (convergence) the
force first pulls, then brakes, so that the mass arrives at rest. No velocity feedback is involved; an
account of the energy keeps the sampled force from giving more than it took.

Run it:  python examples/02_one_fractal_impedance.py

It prints how a mass of 1.5 kg on a frictionless rail behaves after a push of 40 N, once with the attractor and once
with the same force profile as a plain spring, both sampled at 1 kHz. The spring swings for ever, and sampling makes
it swing wider and wider.
"""

from __future__ import annotations

import numpy as np

from pliant.controllers.attractor import Attractor, Law
from pliant.controllers.profiles import ForceProfile
from pliant.signals import ImpedanceTuning

PERIOD = 1e-3  # s
MASS = 1.5  # kg
PUSH = 40.0  # N, during the first 0.3 s

tuning = ImpedanceTuning(
    stiffness=np.array([5000.0]),  # K_0, N/m: force per error near the target
    force_max=np.array([100.0]),  # F_max, N: the force never exceeds it
    range=np.array([0.06]),  # x_b, m: error at which F_max is reached
    linear_range=np.array([0.015]),  # x_0, m: end of the linear part
)
profile = ForceProfile.of(tuning)


def run(law: Law, seconds: float = 6.0) -> np.ndarray:
    """Error (m), force (N) and stored energy (J) at every tick, shape (ticks, 3)."""
    attractor = Attractor(PERIOD, floor=np.array([0.5e-3]), law=law)
    position, velocity = 0.0, 0.0  # m, m/s; the target stays at zero
    state = attractor.init(np.zeros(1))
    rows = []
    for tick in range(round(seconds / PERIOD)):
        error = np.array([0.0 - position])
        force, state = attractor.step(profile, error, state)
        rows.append((error[0], force[0], profile.energy(error)[0]))
        acceleration = (force[0] + (PUSH if tick * PERIOD < 0.3 else 0.0)) / MASS
        position += velocity * PERIOD + 0.5 * acceleration * PERIOD**2
        velocity += acceleration * PERIOD
    return np.array(rows)


def main() -> None:
    print(f"{'s':>5} {'attractor: error mm':>22} {'force N':>9} {'plain spring: error mm':>24} {'force N':>9}")
    attractor, spring = run(Law.CAPPED), run(Law.SPRING)
    for start in (0.0, 0.3, 0.5, 1.0, 2.0, 4.0, 5.8):
        window = slice(round(start / PERIOD), round((start + 0.2) / PERIOD))
        peak = [np.abs(log[window]).max(axis=0) for log in (attractor, spring)]
        numbers = f"{1e3 * peak[0][0]:22.3f} {peak[0][1]:9.2f} {1e3 * peak[1][0]:24.3f} {peak[1][1]:9.2f}"
        print(f"{start:5.1f} {numbers}")
    print("Each row is the largest value in the 0.2 s that begin there.")


if __name__ == "__main__":
    main()
