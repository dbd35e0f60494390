"""Where the robot will be when a command takes effect: the estimate rolled through the torques that are under way."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from pliant.errors import ConfigError
from pliant.estimation.momentum_observer import unit_vector
from pliant.robot import Robot
from pliant.signals import Environment, Estimate
from pliant.spatial import Array


@dataclass(frozen=True)
class SoftContact:
    """A contact whose normal force follows the motion: `λ̇ = −K ẋ_n − B ẍ_n` ([FFMPC] eq. 18), integrated once."""

    frame: str
    stiffness: float
    """K, N/m; an entry of `Estimate.environments` for the frame takes its place"""
    damping: float
    """B, N·s/m"""
    normal: tuple[float, float, float] = (0.0, 0.0, 1.0)
    """outward normal of the surface in the world"""


class DelayPredictor:
    """Rolls an estimate forward with the model, the observed disturbance and, where it touches, a soft contact.

    The disturbance is held over the prediction, and with it the friction at the contact where an observer with
    `contact="normal"` has put it there. That is good for what changes slowly. A disturbance that follows the velocity
    stiffly (table friction that holds a light wrist) is predicted worse than not at all.

    Args:
        robot: the model.
        contact: where it may touch; None for free space.
        step: s, largest step of the integration.

    Raises:
        RobotError: a frame that the robot does not have.
        ConfigError: a step or a stiffness that is not above zero, a negative damping, a normal without length.
    """

    def __init__(self, robot: Robot, contact: SoftContact | None = None, *, step: float = 2.5e-4) -> None:
        if not (math.isfinite(step) and step > 0.0):
            raise ConfigError(f"the step of a prediction must be above zero (s), got {step}")
        self.robot, self.contact, self.longest = robot, contact, step
        self._data = robot.model.createData()  # scratch space: nothing in it outlives a call
        if contact is not None:
            if not (contact.stiffness > 0.0 and contact.damping >= 0.0):
                raise ConfigError(f"a soft contact needs stiffness > 0 and damping >= 0, got {contact}")
            self._index = robot.frame_id(contact.frame)
            self._normal = unit_vector(contact.normal, "normal")

    def predict(self, estimate: Estimate, torques: Sequence[npt.ArrayLike], period: float) -> Estimate:
        """The estimate at the end of the torques that are under way.

        Args:
            estimate: now.
            torques: each (n,) N·m, the next one first; each acts for one period. None of them: the estimate itself.
            period: s.

        Returns:
            The estimate with time, q, v and the contact's normal force moved on; everything else stays.
        """
        if not len(torques):
            return estimate
        count = max(1, math.ceil(period / self.longest - 1e-9))
        held = np.zeros(self.robot.n) if estimate.disturbance is None else estimate.disturbance
        q, v, force = estimate.q, estimate.v, self._force(estimate)
        environment = self._environment(estimate)
        for torque in torques:
            applied = self.robot.vector(torque, "a torque under way") + held
            for _ in range(count):
                q, v, force = self._advance(q, v, force, applied, environment, period / count)
        moved = replace(estimate, time=estimate.time + period * len(torques), q=q, v=v)
        return moved if force is None else self._with_force(moved, force)

    # ------------------------------------------------------------------ inside

    def _force(self, estimate: Estimate) -> float | None:
        """Normal force, N; None where nothing is touched: how far the surface is is not known."""
        if self.contact is None:
            return None
        wrench = estimate.wrenches.get(self.contact.frame)
        if wrench is None or not estimate.contacts.get(self.contact.frame, False):
            return None
        return max(float(self._normal @ np.asarray(wrench[:3])), 0.0)

    def _environment(self, estimate: Estimate) -> Environment | None:
        if self.contact is None:
            return None
        assumed = Environment(self.contact.stiffness, self.contact.damping, math.inf, math.inf)
        return estimate.environments.get(self.contact.frame, assumed)

    def _advance(
        self, q: Array, v: Array, force: float | None, applied: Array, environment: Environment | None, step: float
    ) -> tuple[Array, Array, float | None]:
        """One step of semi-implicit Euler, velocity first."""
        model, data = self.robot.model, self._data
        if force is None or environment is None:
            v_next = v + step * np.array(pin.aba(model, data, q, v, applied))
            return q + step * v_next, v_next, None
        axes = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
        J_n: Array = self._normal @ pin.computeFrameJacobian(model, data, q, self._index, axes)[:3]
        v_next = v + step * np.array(pin.aba(model, data, q, v, applied + J_n * force))
        sinking, change = -float(J_n @ v_next), -float(J_n @ (v_next - v))
        force = max(force + environment.stiffness * step * sinking + environment.damping * change, 0.0)
        return q + step * v_next, v_next, force

    def _with_force(self, estimate: Estimate, force: float) -> Estimate:
        assert self.contact is not None
        wrench = np.array(estimate.wrenches[self.contact.frame])
        wrench[:3] += self._normal * (force - float(self._normal @ wrench[:3]))
        return replace(estimate, wrenches={**estimate.wrenches, self.contact.frame: wrench})
