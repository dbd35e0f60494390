"""Makes the optimal control problem of a robot or a model from a configuration: checks, weights, limits."""

from __future__ import annotations

import math

import numpy as np
import pinocchio as pin

from pliant.errors import ConfigError, RobotError, ShapeError, options
from pliant.mpc.config import MpcConfig
from pliant.mpc.costs import Term
from pliant.mpc.problem import AXES_OF_DIMENSION, MpcProblem, filled
from pliant.rigid_body import mass_matrix
from pliant.robot import Robot
from pliant.spatial import Array, frame_with_z_along


def problem_from_robot(robot: Robot, config: MpcConfig) -> MpcProblem:
    """Binds a configuration to a robot on a fixed base, branched or not.

    Raises:
        RobotError: a frame that the robot does not have.
        ConfigError: activations that do not fit the robot; a stiffness or damping outside the integrator's range.
    """
    for frame in (config.frame, config.contact.frame or config.frame):
        robot.frame_id(frame)
    return _bound(config, robot.name, robot.model, tuple(range(robot.n)), robot.torque_limit, robot.home)


def problem_from_model(model: pin.Model, config: MpcConfig, posture: Array) -> MpcProblem:
    """Binds a configuration to any pinocchio model, for the crocoddyl bridge; a free-flyer at its root is not driven.

    Args:
        model: tree, with or without a free base.
        config: what to build.
        posture: (nq,) at which the contact's stiffness is checked.

    Raises:
        RobotError: a frame that the model does not have.
        ShapeError: a posture of another size.
        ConfigError: as `problem_from_robot`.
    """
    for frame in (config.frame, config.contact.frame or config.frame):
        if not model.existFrame(frame):
            names = [entry.name for entry in model.frames]
            raise RobotError(f"the model {model.name!r} has no frame {frame!r}; {options(names, frame)}")
    if posture.shape != (model.nq,):
        raise ShapeError(f"the posture must have {model.nq} entries, got shape {posture.shape}")
    base = model.joints[1].nv if model.njoints > 1 and model.joints[1].shortname() == "JointModelFreeFlyer" else 0
    limit = np.array(model.upperEffortLimit)[base:]
    limit = np.where(limit > 0.0, limit, np.inf)
    return _bound(config, model.name, model, tuple(range(base, model.nv)), limit, posture)


def _bound(
    config: MpcConfig, name: str, model: pin.Model, driven: tuple[int, ...], limit: Array, posture: Array
) -> MpcProblem:
    stiffness_max = _check_contact_range(config, model, posture)
    R = frame_with_z_along(config.contact.normal)
    weights = {phase: _weights(config, phase, model.nv, len(driven)) for phase in config.phases}
    return MpcProblem(config, name, model, driven, limit, R, weights, stiffness_max)


def _weights(config: MpcConfig, phase: str, nv: int, nu: int) -> dict[str, Array]:
    costs = config.phases[phase].over(config.costs)
    model = config.predictive_model
    m = config.contact.dimension if model.touches else 0

    def along(name: str, size: int, *, per_joint: bool = False) -> Array:
        term: Term = getattr(costs, name)
        return term.along(config.horizon, size, config.dt, f"{name} (phase {phase!r})", per_joint=per_joint)

    table = {
        "state_weight": np.hstack([along("posture", nv, per_joint=True), along("joint_velocity", nv, per_joint=True)]),
        "torque_gravity_weight": along("torque", nu, per_joint=True),
        "translation_weight": along("translation", 3),
        "rotation_weight": along("rotation", 3),
        "velocity_weight": along("velocity", 6),
    }
    if model.torque_state:
        table["control_gravity_weight"] = along("unfiltered_torque", nu, per_joint=True)
    if m:
        table["force_weight"] = along("force", m)
    if model.force_state:
        table["force_rate_weight"] = along("force_rate", m)
    return table


def _check_contact_range(config: MpcConfig, model: pin.Model, posture: Array) -> float:
    """The sampled force state must be stable: see docs/mpc.md for the two conditions. Returns the largest stiffness
    along the normal for which it is."""
    if not config.predictive_model.force_state:
        return math.inf
    contact, dt = config.contact, config.dt
    inertia = task_inertia(config, model, posture)
    stiffness, damping = (filled(values, contact.dimension) for values in (contact.stiffness, contact.damping))
    exponential = contact.integrator == "exponential"
    largest = inertia / dt**2 if exponential else (1.0 - 1e-6) * damping / dt
    for axis, (K, B) in enumerate(zip(stiffness, damping, strict=True)):
        if exponential:
            stiffest = float(largest[axis])
            if stiffest < K:
                raise ConfigError(
                    f"contact.stiffness of axis {axis}: the exponential integrator needs K dt² ≤ Λ, got K = {K:g} with"
                    f" dt = {dt:g} s and Λ = {inertia[axis]:.3g} (K at most {stiffest:.3g}); shorten dt"
                )
        elif K * dt >= B or B * dt >= 2.0 * float(inertia[axis]) + 0.5 * K * dt**2:
            raise ConfigError(
                f"contact axis {axis}: the Euler integrator needs K dt < B and B dt < 2 Λ + K dt²/2, got K = {K:g}, B ="
                f" {B:g}, dt = {dt:g} s, Λ = {inertia[axis]:.3g}; use integrator = 'exponential' or a shorter dt"
            )
    return float(largest[0 if contact.dimension == 1 else 2])


def task_inertia(config: MpcConfig, model: pin.Model, posture: Array) -> Array:
    """(m,) inertia that each axis of the contact feels, kg and kg m², in axes nearly those of the contact."""
    data = model.createData()
    pin.computeJointJacobians(model, data, posture)
    pin.updateFramePlacements(model, data)
    frame = model.getFrameId(config.contact.frame or config.frame)
    local = config.contact.axes == "local"
    J_world = pin.getFrameJacobian(model, data, frame, pin.LOCAL if local else pin.LOCAL_WORLD_ALIGNED)
    R = frame_with_z_along(config.contact.normal).T if config.contact.axes == "surface" else np.eye(3)
    J = np.vstack([R @ J_world[:3], R @ J_world[3:]])
    M = mass_matrix(model, data, posture)
    mobility = np.einsum("ij,ji->i", J, np.linalg.solve(M, J.T))[list(AXES_OF_DIMENSION[config.contact.dimension])]
    return 1.0 / np.maximum(mobility, 1e-9)
