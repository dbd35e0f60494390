"""Springs at the joint limits, around any controller."""

from __future__ import annotations

import math
from collections import ChainMap
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from pliant.configuration import Config
from pliant.interfaces import ChannelUnit, Controller, HasUnit, Needs
from pliant.quantity import quantity
from pliant.robot import Robot
from pliant.signals import Command, Estimate, Reference
from pliant.spatial import Array

_UNLIMITED = 100.0  # N·m or N, of a joint whose file gives no torque limit


class JointLimitsConfig(Config):
    """A spring at each end of each joint's range."""

    margin: float = quantity(
        math.radians(10.0),
        "rad",
        "distance from a position limit at which its spring begins",
        shown=(0.01, 0.5),
        gt=0.0,
    )
    share: float = quantity(
        0.5, "1", "torque of the spring at the limit and beyond, as a share of the joint's torque limit", gt=0.0, le=1.0
    )


@dataclass(frozen=True, slots=True)
class JointLimitsState:
    """State of the inner controller, and the springs' account."""

    inner: Any
    q: Array
    """(n,) joint positions of the last tick, rad"""
    step: Array
    """(n,) joint motion in the last period, rad"""
    sent: Array
    """(n,) torque of the springs that was sent in the last tick, N·m"""
    account: Array
    """(n,) what each spring has taken in and not given back since the joint came near its limit, J"""


class JointLimits(Controller[JointLimitsState]):
    """Adds, near a joint's limits, a torque that pushes it back: τ = ∓min(K x, F) with x the way into the margin and
    K = F/margin.

    A spring that is sampled gives out more than it took in. Each joint therefore keeps an account of Σ −τ_sent·Δq, and
    on the way out its torque is at most what the account holds, over a step as long as the last one and the change to
    it. So entering and leaving the margin takes energy out of the robot; where a step is longer than predicted, at most
    the torque times the difference is given out. A joint that starts within its margin begins with the energy of its
    spring.

    The springs are added to the controller's own torque, and only they are reduced where the sum exceeds a torque
    limit. The channel `energy/joint_limits` is the sum of the accounts, `joint_limits/torque` what the springs sent.

    Args:
        inner: any controller.
        robot: for position and torque limits; a joint without finite position limits has no spring, nor has a side
            whose margin would reach beyond the middle of the range: there the margin ends in the middle.
        config: margin and torque.
    """

    def __init__(self, inner: Controller[Any], robot: Robot, config: JointLimitsConfig | None = None) -> None:
        config = config or JointLimitsConfig()
        self.inner, self.config = inner, config
        self._limit: Array = robot.torque_limit
        lower, upper = robot.position_lower, robot.position_upper
        span = upper - lower
        limited = np.isfinite(span) & (span > 0.0) & (span < 1e3)
        margin = np.where(limited, np.minimum(config.margin, 0.5 * np.where(limited, span, 1.0)), 1.0)
        self._from = np.where(limited, upper - margin, np.inf)
        self._to = np.where(limited, lower + margin, -np.inf)
        self.torque_max: Array = config.share * np.where(np.isfinite(self._limit), self._limit, _UNLIMITED)
        self.stiffness: Array = self.torque_max / margin

    @property
    def needs(self) -> Needs:
        return self.inner.needs

    @property
    def channels(self) -> Mapping[str, HasUnit]:
        added = {"energy/joint_limits": ChannelUnit("J"), "joint_limits/torque": ChannelUnit("N·m")}
        return {**self.inner.channels, **added}

    @property
    def regulates_force(self) -> bool:
        return self.inner.regulates_force

    def init(self, estimate: Estimate) -> JointLimitsState:
        inner, zero = self.inner.init(estimate), np.zeros_like(estimate.q)
        return JointLimitsState(inner, estimate.q, zero, zero, self._energy(self._depth(estimate.q)))

    def step(
        self, estimate: Estimate, reference: Reference, state: JointLimitsState
    ) -> tuple[Command, JointLimitsState]:
        command, inner = self.inner.step(estimate, reference, state.inner)
        step = estimate.q - state.q
        depth = self._depth(estimate.q)
        account = np.where(depth != 0.0, state.account - state.sent * step, 0.0)
        wanted = -np.copysign(np.minimum(self.stiffness * np.abs(depth), self.torque_max), depth)
        wanted = np.where(depth != 0.0, wanted, 0.0)
        ahead = np.abs(step) + np.abs(step - state.step)
        outward = step * depth < 0.0
        most = np.maximum(account, 0.0) / np.maximum(ahead, 1e-12)
        wanted = np.where(outward, np.clip(wanted, -most, most), wanted)
        torque = np.clip(command.torque + wanted, -self._limit, self._limit)
        sent = torque - command.torque
        added: dict[str, float | Array] = {"energy/joint_limits": float(account.sum()), "joint_limits/torque": sent}
        diagnostics: ChainMap[str, Any] = ChainMap(added, command.diagnostics)  # type: ignore[arg-type]  # only read
        whole = Command(command.time, torque, command.clamped + wanted - sent, diagnostics)
        return whole, JointLimitsState(inner, estimate.q, step, sent, account)

    def kept_back(self, state: JointLimitsState, torque: Array) -> JointLimitsState:
        inner = self.inner.kept_back(state.inner, torque)
        return JointLimitsState(inner, state.q, state.step, state.sent, state.account)

    def _depth(self, q: Array) -> Array:
        """(n,) x: how far each joint is within its margin, rad; above zero at the upper end, below at the lower."""
        return np.maximum(q - self._from, 0.0) + np.minimum(q - self._to, 0.0)

    def _energy(self, depth: Array) -> Array:
        """(n,) ∫ min(K x, F) dx, J."""
        x, F, K = np.abs(depth), self.torque_max, self.stiffness
        return np.where(K * x <= F, 0.5 * K * x**2, F * x - 0.5 * F**2 / K)


def with_joint_limits(controller: Controller[Any], robot: Robot, config: JointLimitsConfig | None) -> Controller[Any]:
    """The controller with springs at the joint limits; the controller itself without a configuration."""
    return controller if config is None else JointLimits(controller, robot, config)
