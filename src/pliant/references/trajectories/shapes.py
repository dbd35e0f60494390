"""Closed paths for the tool: lemniscate, line and circle. Each starts at time zero with its full speed; see `eased`."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from pliant.errors import ConfigError, ShapeError
from pliant.references.trajectories.trajectory import Point, Trajectory, positive, vector
from pliant.spatial import Array, unit


class Harmonics(Trajectory):
    """A sum of sines: x(t) = centre + Σ_i a_i sin(ω_i t + φ_i).

    Args:
        centre: (k,) m.
        amplitudes: (h, k) m, one row per sine.
        frequencies: (h,) rad/s.
        phases: (h,) rad; zero if left out.
    """

    def __init__(
        self,
        centre: npt.ArrayLike,
        amplitudes: npt.ArrayLike,
        frequencies: npt.ArrayLike,
        phases: npt.ArrayLike | None = None,
    ) -> None:
        self._centre = vector(centre, "the centre")
        self.size, self.duration = self._centre.shape[0], math.inf
        self._amplitudes: Array = np.array(amplitudes, dtype=np.float64)
        self._frequencies = [float(w) for w in vector(frequencies, "the frequencies")]
        count = len(self._frequencies)
        self._phases = [0.0] * count if phases is None else [float(p) for p in vector(phases, "the phases", count)]
        if self._amplitudes.shape != (count, self.size):
            raise ShapeError(f"amplitudes must have shape ({count}, {self.size}), got {self._amplitudes.shape}")
        if not np.isfinite(self._amplitudes).all():
            raise ConfigError(f"amplitudes must be finite, got {self._amplitudes.tolist()}")

    def at(self, time: float) -> Point:
        angles = [w * time + p for w, p in zip(self._frequencies, self._phases, strict=True)]
        sines = [math.sin(angle) for angle in angles]
        rates = [w * math.cos(angle) for w, angle in zip(self._frequencies, angles, strict=True)]
        bends = [-w * w * s for w, s in zip(self._frequencies, sines, strict=True)]
        factors = np.array((sines, rates, bends)) @ self._amplitudes  # (3, h) @ (h, k)
        factors[0] += self._centre
        return Point(factors[0], factors[1], factors[2])

    def rows(self, times: Array) -> Point:
        value, rate, bend = np.zeros((3, len(times), self.size))
        for w, phase, amplitude in zip(self._frequencies, self._phases, self._amplitudes, strict=True):
            angle = w * times + phase
            sine = np.sin(angle)[:, None]
            value += sine * amplitude
            rate += (w * np.cos(angle))[:, None] * amplitude
            bend -= w * w * sine * amplitude
        return Point(value + self._centre, rate, bend)


def lemniscate(
    period: float = 4.0,
    centre: npt.ArrayLike = (0.0, -0.6, 0.5),
    width: float = 0.1,
    height: float = 0.2,
    across: npt.ArrayLike = (1.0, 0.0, 0.0),
    up: npt.ArrayLike = (0.0, 0.0, 1.0),
) -> Harmonics:
    """The figure-8 of [Stack] Tiseo et al. 2020, sec. III-A.

    Along `across` it moves as width·sin(4πt/T), along `up` as height·sin(2πt/T).

    Args:
        period: T, s.
        centre: (3,) m.
        width: amplitude in m of the fast sine along `across`.
        height: amplitude in m of the slow sine along `up`.
        across: (3,) direction.
        up: (3,) direction.
    """
    w = 2.0 * math.pi / positive(period, "the period of a lemniscate", "s")
    rows = np.stack([width * unit(across, "across"), height * unit(up, "up")])
    return Harmonics(vector(centre, "the centre", 3), rows, (2.0 * w, w))


def sine_line(
    amplitude: float = 0.5,
    peak_speed: float = 0.7,
    centre: npt.ArrayLike = (0.0, -0.6, 0.5),
    direction: npt.ArrayLike = (1.0, 0.0, 0.0),
) -> Harmonics:
    """To and fro on a straight line, x = centre + amplitude·sin(ωt) along `direction`, ω = peak_speed/amplitude.

    Args:
        amplitude: m to either side of the centre.
        peak_speed: m/s at the centre.
        centre: (3,) m.
        direction: (3,), any length above zero.
    """
    frequency = positive(peak_speed, "the peak speed", "m/s") / positive(amplitude, "the amplitude", "m")
    return Harmonics(vector(centre, "the centre", 3), amplitude * unit(direction, "direction")[None], (frequency,))


def circle(
    start: npt.ArrayLike,
    radius: float,
    speed: float,
    towards_centre: npt.ArrayLike = (1.0, 0.0, 0.0),
    heading: npt.ArrayLike = (0.0, -1.0, 0.0),
) -> Harmonics:
    """A circle that begins at `start`: x = start + R(1 − cos ωt) along `towards_centre` + R sin ωt along `heading`.

    With the defaults it is the polishing circle (x_0 + R(1 − cos ωt), y_0 − R sin ωt, z_0).

    Args:
        start: (3,) m.
        radius: R, m.
        speed: ω, rad/s.
        towards_centre: (3,) direction from the start to the centre.
        heading: (3,) direction of the first motion, perpendicular to it.

    Raises:
        ConfigError: the two directions are not perpendicular.
    """
    R = positive(radius, "the radius of a circle", "m")
    inward, forward = unit(towards_centre, "towards_centre"), unit(heading, "heading")
    if abs(float(inward @ forward)) > 1e-9:
        raise ConfigError(
            f"towards_centre and heading must be perpendicular, got {inward.tolist()} and {forward.tolist()}"
        )
    centre = vector(start, "the start", 3) + R * inward
    w = positive(speed, "the speed of a circle", "rad/s")
    return Harmonics(centre, np.stack([-R * inward, R * forward]), (w, w), (0.5 * math.pi, 0.0))
