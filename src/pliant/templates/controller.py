"""MyController: a damped spring between a frame and its reference, with gravity compensated. Make it yours."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pinocchio as pin
from pydantic import Field

from pliant.entries import ControllerConfig
from pliant.interfaces import ChannelUnit, Controller, Needs
from pliant.quantity import quantity
from pliant.robot import Robot
from pliant.signals import Command, Estimate, Reference


class MyController(Controller[pin.Data]):
    """A damped spring between a frame and its reference."""

    class Config(ControllerConfig):
        """Parameters; each is a `--set control.NAME=VALUE`. `frame` becomes the task's first frame by itself."""

        frame: str = Field(default="flange", description="frame that is pulled")
        stiffness: float = quantity(500.0, "N/m", "K", gt=0.0)
        damping: float = quantity(20.0, "1/s", "of joints", ge=0.0)

    def __init__(self, robot: Robot, config: Config, period: float) -> None:
        self.robot, self.config, self.period = robot, config, period  # period of control, s

    @property
    def needs(self) -> Needs:
        """Signals that it needs beyond joint positions and velocities, such as Needs(wrench=True)."""
        return Needs()

    @property
    def channels(self) -> Mapping[str, ChannelUnit]:
        """Unit of each diagnostic."""
        return {"spring/force": ChannelUnit("N")}

    def init(self, estimate: Estimate) -> pin.Data:
        """State before the first step; here only the model's buffers. `step` must not keep any state elsewhere."""
        return self.robot.model.createData()

    def step(self, estimate: Estimate, reference: Reference, state: pin.Data) -> tuple[Command, pin.Data]:
        """τ = Jᵀ K (x_d − x) − d M(q) q̇ + g(q), within the limits: light joints get little damping."""
        model, frame = self.robot.model, self.robot.frame_id(self.config.frame)
        axes = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
        J = pin.computeFrameJacobian(model, state, estimate.q, frame, axes)[:3]  # m/rad, (3, n)
        position = pin.updateFramePlacement(model, state, frame).translation  # m, world
        target = next((task.position for task in reference.tasks if task.frame == self.config.frame), position)
        force = self.config.stiffness * (np.asarray(target) - position)  # N, world
        gravity = pin.computeGeneralizedGravity(model, state, estimate.q)  # N·m
        M = np.array(pin.crba(model, state, estimate.q, pin.Convention.WORLD))  # kg m², (n, n)
        wanted = J.T @ force - self.config.damping * M @ estimate.v + gravity
        torque = np.clip(wanted, -self.robot.torque_limit, self.robot.torque_limit)
        return Command(estimate.time, torque, wanted - torque, {"spring/force": force}), state
