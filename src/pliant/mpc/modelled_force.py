"""Force feedback without a force sensor: the contact force is computed from the state with a spring and damper model.

[FFMPC] Kleff, Jordana, Mansard, Righetti, "Force feedback in model predictive control: a soft contact approach", 2024,
sec. V-B, the "naive approach to visco-elastic contact".
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
import pinocchio as pin

from pliant._mpc import ControllerState as MpcState
from pliant.errors import ConfigError
from pliant.frozen import changed
from pliant.interfaces import Controller, Needs
from pliant.mpc import diagnostics
from pliant.mpc.config import MpcConfig
from pliant.mpc.controller import MpcController
from pliant.robot import Robot
from pliant.signals import Command, Estimate, Reference, TaskReference
from pliant.spatial import Array


@dataclass(frozen=True, slots=True)
class ModelledForceState:
    """State of the inner controller, and the assumed contact point."""

    inner: MpcState
    anchor: Array | None = None
    """p_c (3,) m: where the surface is assumed; None: no contact"""


class ModelledForceMpc(Controller[ModelledForceState]):
    """Predicts as force feedback does, from λ = −K (p − p_c)·n − B ṗ·n ([FFMPC] eq. 16) instead of a measured force.

    Equations 16 and 18 are one model, the second the time derivative of the first: with λ of the model at the start
    of the horizon the force state is a function of q and v, so that (q, v) is the whole state. p_c is the position of
    the reference when its phase with contact began: the believed surface. Where that phase began because contact is
    felt, p_c is where the frame was then: the reference is below the surface by what the arm lags behind it, and 3 mm
    of that are 90 N at 3e4 N/m.

    Args:
        robot: serial, at most 8 joints.
        config: of kind "force_feedback", contact of dimension 1.
        period: s from step to step.

    Raises:
        ConfigError: another kind or dimension, and what `MpcController` refuses.
        RobotError: a robot that the kernel cannot take, an unknown frame.
    """

    def __init__(self, robot: Robot, config: MpcConfig, period: float | None = None) -> None:
        if config.kind != "force_feedback" or config.contact.dimension != 1:
            raise ConfigError(
                "a modelled force needs kind = 'force_feedback' and contact.dimension = 1, got"
                f" {config.kind!r} and {config.contact.dimension}"
            )
        self.robot, self.config = robot, config
        self.inner = MpcController(robot, config, period)
        self._frame = self.inner.problem.contact_frame
        self._index = robot.frame_id(self._frame)
        self._data = robot.model.createData()  # scratch space: nothing in it outlives a step

    @property
    def needs(self) -> Needs:
        return replace(self.inner.needs, wrench=False)

    @property
    def regulates_force(self) -> bool:
        """True: it regulates the force of its model to the reference's, without a measurement."""
        return True

    @property
    def channels(self) -> Mapping[str, diagnostics.DiagnosticChannel]:
        return {**self.inner.channels, "mpc/modelled_force": diagnostics.DiagnosticChannel("N")}

    def init(self, estimate: Estimate) -> ModelledForceState:
        return ModelledForceState(self.inner.init(self._felt(estimate, np.zeros(6))))

    def step(
        self, estimate: Estimate, reference: Reference, state: ModelledForceState
    ) -> tuple[Command, ModelledForceState]:
        task = next((one for one in reference.tasks if one.frame == self.config.frame), reference.tasks[0])
        J = self._jacobian(estimate)
        anchor = self._anchor(reference, estimate, task, state.anchor)
        wrench = np.zeros(6)
        if anchor is not None:
            wrench[:3] = self._force(J, estimate, task, anchor)
        command, inner = self.inner.step(self._felt(estimate, wrench), reference, state.inner)
        diagnosed = {**command.diagnostics, "mpc/modelled_force": float(np.linalg.norm(wrench[:3]))}
        return changed(command, diagnostics=diagnosed), ModelledForceState(inner, anchor)

    # ------------------------------------------------------------------ inside

    def _felt(self, estimate: Estimate, wrench: Array) -> Estimate:
        return changed(estimate, wrenches={**estimate.wrenches, self._frame: wrench})

    def _jacobian(self, estimate: Estimate) -> Array:
        """(6, n) of the frame, in world axes; its placement is in the scratch space then."""
        axes = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
        return pin.computeFrameJacobian(self.robot.model, self._data, estimate.q, self._index, axes)

    def _anchor(
        self, reference: Reference, estimate: Estimate, task: TaskReference, before: Array | None
    ) -> Array | None:
        felt = estimate.contacts.get(self._frame, False)
        touches = felt
        if self.config.phase_by == "name":
            phase = self.config.phases.get(reference.phase)
            touches = phase is not None and phase.contact
        if not touches or before is not None:
            return before if touches else None
        return np.array(self._data.oMf[self._index].translation if felt else task.position)

    def _force(self, J: Array, estimate: Estimate, task: TaskReference, anchor: Array) -> Array:
        """(3,) N in world axes; a pull as well, as in the paper, whose model is bilateral."""
        contact = self.config.contact
        placement = self._data.oMf[self._index]
        normal = self._normal(np.array(placement.rotation), task)
        depth = float(normal @ (anchor - placement.translation))
        rate = float(normal @ (J[:3] @ estimate.v))
        return (contact.stiffness[0] * depth - contact.damping[0] * rate) * normal

    def _normal(self, R: Array, task: TaskReference) -> Array:
        contact = self.config.contact
        if contact.axes == "local":
            return R[:, 2]
        if contact.axes == "world":
            return np.array([0.0, 0.0, 1.0])
        if task.task_rotation is not None:
            return task.task_rotation[:, 2]
        return np.array(contact.normal) / np.linalg.norm(contact.normal)
