"""Mass, centre of mass and sensor bias of a tool from the readings of a force/torque sensor at rest.

In the sensor's axes, with g the acceleration of gravity there, a tool of mass m with its centre at c reads

    f = m g + b_f                   4 unknowns, 3 equations per pose
    μ = (m c) × g + b_μ             6 unknowns, 3 equations per pose

linear in m, m c and the biases. The two systems are solved separately by least squares, because the noise of forces and
moments differs. The standard uncertainties follow from the residuals: they include everything that varies from pose to
pose: noise and errors of the arm's orientation.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from pliant.errors import ConfigError, ShapeError, SignalError
from pliant.estimation.carried_mass import CarriedMass
from pliant.spatial import Array, skew

CONDITION_LIMIT = 30.0
"""largest condition number of the regressors, gravity scaled to one"""
LEAST_POSES = 4
"""least number of poses; three would be enough for a fit, but not for an estimate of the noise"""


@dataclass(frozen=True, slots=True)
class ToolIdentification:
    """Identified load and bias of a sensor, in the sensor's axes. Each `…_std` is a standard uncertainty."""

    mass: float
    """kg"""
    mass_std: float
    center: Array | None
    """c (3,), m; None where the mass is within three standard uncertainties of zero"""
    center_std: Array | None
    first_moment: Array
    """m c (3,), kg m"""
    first_moment_std: Array
    bias: Array
    """(6,) what the sensor reads without any load, N and N·m"""
    bias_std: Array
    noise: tuple[float, float]
    """standard deviation of a pose's force (N) and moment (N·m) about the fit"""
    freedom: tuple[int, int]
    """degrees of freedom of those two: the standardised errors follow Student's t with as many"""
    condition: float
    """the larger condition number of the two regressors: how informative the poses are"""

    def carried(self) -> CarriedMass:
        """The load that the wrench estimator subtracts from the readings of this sensor."""
        center = np.zeros(3) if self.center is None else self.center
        b = [float(x) for x in self.bias]
        return CarriedMass(
            self.mass if self.center is not None else 0.0,
            (float(center[0]), float(center[1]), float(center[2])),
            (b[0], b[1], b[2], b[3], b[4], b[5]),
        )


def identify_tool(
    readings: npt.ArrayLike,
    rotations: npt.ArrayLike,
    gravity: npt.ArrayLike = (0.0, 0.0, -9.81),
    condition_limit: float = CONDITION_LIMIT,
) -> ToolIdentification:
    """Fits mass, centre and biases.

    One row must be one pose: average the samples of a pose first, else what they have in common (the arm's pose error)
    is counted as if it were independent in every sample, and the uncertainties come out too small.

    Args:
        readings: (N, 6) wrench of the sensor at rest, in its own axes, free of contact, N and N·m.
        rotations: (N, 3, 3) R_world_sensor of the same poses.
        gravity: (3,) acceleration of gravity in the world, m/s².
        condition_limit: poses with a larger condition number are refused.

    Raises:
        ConfigError: too few poses, or poses between which the direction of gravity hardly changes in the sensor's axes.
        ShapeError: shapes that do not fit each other. SignalError: a value that is not finite.
    """
    wrenches, R = _checked(readings, rotations)
    g_world = np.asarray(gravity, dtype=np.float64)
    g = np.einsum("nji,j->ni", R, g_world)  # (N, 3) in the sensor's axes
    scale = float(np.linalg.norm(g_world))
    condition = excitation(R, g_world)
    if condition > condition_limit:
        raise ConfigError(
            f"the poses do not excite the tool enough: condition number {condition:.3g}, at most {condition_limit:g};"
            " turn the sensor so that gravity points along at least three clearly different directions in its axes"
        )
    force, force_cov, force_noise, force_freedom = _least_squares(_force_regressor(g / scale), wrenches[:, :3])
    moment, moment_cov, moment_noise, moment_freedom = _least_squares(_moment_regressor(g / scale), wrenches[:, 3:])
    mass, mass_std = float(force[0]) / scale, math.sqrt(force_cov[0, 0]) / scale
    first, first_cov = moment[:3] / scale, moment_cov[:3, :3] / scale**2
    center = center_std = None
    if mass > 3.0 * mass_std:
        center = first / mass
        # first-order propagation; forces and moments are independent
        center_std = np.sqrt(np.diag(first_cov) / mass**2 + (center * mass_std / mass) ** 2)
    return ToolIdentification(
        mass=mass,
        mass_std=mass_std,
        center=center,
        center_std=center_std,
        first_moment=first,
        first_moment_std=np.sqrt(np.diag(first_cov)),
        bias=np.concatenate([force[1:], moment[3:]]),
        bias_std=np.sqrt(np.concatenate([np.diag(force_cov)[1:], np.diag(moment_cov)[3:]])),
        noise=(force_noise, moment_noise),
        freedom=(force_freedom, moment_freedom),
        condition=condition,
    )


def excitation(rotations: npt.ArrayLike, gravity: npt.ArrayLike = (0.0, 0.0, -9.81)) -> float:
    """Condition number of the worse of the two regressors, gravity scaled to one; infinite where they are singular.

    Args:
        rotations: (N, 3, 3) R_world_sensor.
        gravity: (3,) in the world, any length above zero.
    """
    down = np.asarray(gravity, dtype=np.float64)
    g = np.einsum("nji,j->ni", np.asarray(rotations, dtype=np.float64), down / np.linalg.norm(down))
    singular = [np.linalg.svd(A, compute_uv=False) for A in (_force_regressor(g), _moment_regressor(g))]
    return max(float(s[0] / s[-1]) if s[-1] > 1e-12 * s[0] else math.inf for s in singular)


# ---------------------------------------------------------------------- inside


def _checked(readings: npt.ArrayLike, rotations: npt.ArrayLike) -> tuple[Array, Array]:
    wrenches, R = np.asarray(readings, dtype=np.float64), np.asarray(rotations, dtype=np.float64)
    if wrenches.ndim != 2 or wrenches.shape[1] != 6 or R.shape != (wrenches.shape[0], 3, 3):
        raise ShapeError(
            f"readings must be (N, 6) and rotations (N, 3, 3) with one N, got {wrenches.shape} and {R.shape}"
        )
    if wrenches.shape[0] < LEAST_POSES:
        raise ConfigError(f"identifying a tool takes at least {LEAST_POSES} poses, got {wrenches.shape[0]}")
    if not (np.isfinite(wrenches).all() and np.isfinite(R).all()):
        raise SignalError("readings and rotations must be finite")
    return wrenches, R


def _force_regressor(g: Array) -> Array:
    """(3N, 4) of (m, b_f). Args: g (N, 3)."""
    return np.concatenate([np.column_stack([row, np.eye(3)]) for row in g])


def _moment_regressor(g: Array) -> Array:
    """(3N, 6) of (m c, b_μ). Args: g (N, 3)."""
    return np.concatenate([np.column_stack([-skew(row), np.eye(3)]) for row in g])


def _least_squares(A: Array, values: Array) -> tuple[Array, Array, float, int]:
    """Parameters (k,), their covariance (k, k), residual standard deviation, degrees of freedom."""
    y = values.reshape(-1)
    parameters = np.asarray(np.linalg.lstsq(A, y, rcond=None)[0], dtype=np.float64)
    freedom = A.shape[0] - A.shape[1]
    variance = float(np.sum((y - A @ parameters) ** 2)) / freedom
    return parameters, variance * np.linalg.inv(A.T @ A), math.sqrt(variance), freedom
