"""The optimal control problem of a predictive controller for one robot: dimensions, checks and parameters of its
nodes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from pliant.errors import ConfigError, options
from pliant.mpc.config import MpcConfig
from pliant.mpc.horizon import HorizonReference
from pliant.mpc.nodes import NodeParameters, PlainNodes
from pliant.spatial import Array

AXES_OF_DIMENSION = {1: (2,), 3: (0, 1, 2), 6: (0, 1, 2, 3, 4, 5)}


@dataclass(frozen=True)
class MpcProblem:
    """A configuration bound to a robot. Make it with `problem_from_robot` or `problem_from_model`."""

    config: MpcConfig
    name: str
    """of the robot"""
    model: pin.Model
    driven: tuple[int, ...]
    """(nu,) index in v of each driven joint; a free base is not driven"""
    torque_limit: Array
    """(nu,) N·m"""
    R_world_surface: Array
    """(3, 3), its third column is the normal"""
    weights: dict[str, dict[str, Array]]
    """phase → name in NodeParameters → (N+1, size)"""
    stiffness_max: float
    """N/m along the normal, up to which the force state can be integrated; infinite where there is none"""

    @property
    def m(self) -> int:
        """Dimension of the contact force; 0 in free motion."""
        return self.config.contact.dimension if self.config.predictive_model.touches else 0

    @property
    def nu(self) -> int:
        """Number of driven joints."""
        return len(self.driven)

    @property
    def contact_frame(self) -> str:
        return self.config.contact.frame or self.config.frame

    def normals(self, R_world_task: Array | None) -> Array:
        """(..., 3) outward normals in the world along which a force is regulated, for task axes (..., 3, 3)."""
        surface = self.config.contact.axes == "surface"
        return self.contact_axes(None, R_world_task)[..., 2] if surface else np.array([0.0, 0.0, 1.0])

    def nodes(self) -> PlainNodes:
        """Parameters of the horizon as plain arrays, constants filled in."""
        nodes = PlainNodes.zeros(self.config.horizon + 1, self.model.nq, self.model.nv, self.nu, self.m)
        self.write_constants(nodes)
        return nodes

    def write_constants(self, nodes: NodeParameters) -> None:
        """Writes what stays the same during a run: the contact, bounds."""
        self.write_contact(nodes)
        self.write_torque_bounds(nodes, np.zeros(self.nu))
        bounds = self.config.bounds
        if self.m and bounds.force_max is not None:
            normal = 0 if self.m == 1 else 2
            nodes.force_lower[:, normal] = 0.0
            nodes.force_upper[:, normal] = bounds.force_max
        if bounds.friction is not None:
            nodes.friction[...] = bounds.friction

    def write_contact(self, nodes: NodeParameters) -> None:
        """Writes stiffness, damping and friction of the contact, as configured."""
        nodes.stiffness[...] = filled(self.config.contact.stiffness, self.m)
        nodes.damping[...] = filled(self.config.contact.damping, self.m)
        if self.config.contact.friction is not None:
            nodes.sliding_friction[...] = self.config.contact.friction

    def write_torque_bounds(self, nodes: NodeParameters, disturbance: Array) -> None:
        """Writes the limits, if they are bounds, of a torque ũ of which ũ − disturbance (nu,) N·m is sent."""
        if self.config.bounds.torque:
            nodes.torque_lower[...] = disturbance - self.torque_limit
            nodes.torque_upper[...] = disturbance + self.torque_limit

    def write_phases(self, nodes: NodeParameters, phases: Sequence[str], *, oriented: bool = True) -> None:
        """Gives each node the weights and the contact of its own phase.

        Args:
            nodes: written to.
            phases: (N+1,) names.
            oriented: whether the task has an orientation; without one its cost is off.

        Raises:
            ConfigError: a phase that the configuration does not have.
        """
        for node, phase in enumerate(phases):
            if phase not in self.weights:
                raise ConfigError(f"no costs for phase {phase!r}; {options(self.weights, phase)}")
            for name, table in self.weights[phase].items():
                getattr(nodes, name)[node] = table[node]
            nodes.contact_active[node] = self.m > 0 and self.config.phases[phase].contact
        if not oriented:
            nodes.rotation_weight[...] = 0.0

    def write_references(self, nodes: NodeParameters, reference: HorizonReference, posture: Array) -> None:
        """Gives each node its references.

        Args:
            nodes: written to.
            reference: at the N + 1 nodes.
            posture: (nq,) rad, where the reference has none.
        """
        nq = self.model.nq
        use = self.config.posture == "reference" and reference.posture is not None
        nodes.state_reference[:, :nq] = reference.posture if use else posture
        nodes.translation_reference[...] = reference.position
        if reference.rotation is not None:
            nodes.rotation_reference[...] = reference.rotation
        self.write_axes(nodes, reference.task_rotation)
        if self.config.task_velocity:
            nodes.velocity_reference[...] = reference.velocity
        if self.m:
            axes = self.contact_axes(reference.rotation, reference.task_rotation)
            nodes.force_reference[...] = self.in_contact_axes(reference.wrench, axes)

    def write_axes(self, nodes: NodeParameters, R_world_task: Array | None) -> None:
        """Gives each node the axes of its task, (..., 3, 3), where the contact's are those of the surface."""
        if self.config.contact.axes == "surface":
            nodes.task_rotation[...] = self.contact_axes(None, R_world_task)

    def contact_axes(self, R_world_contact: Array | None, R_world_task: Array | None) -> Array:
        """(..., 3, 3) axes of the contact force in the world.

        Args:
            R_world_contact: (..., 3, 3) orientation of the contact frame, for axes 'local'; None: the world's.
            R_world_task: (..., 3, 3) axes of the task, for axes 'surface'; None: those of the configured normal.
        """
        axes = self.config.contact.axes
        if axes == "surface":
            return self.R_world_surface if R_world_task is None else R_world_task
        return np.eye(3) if axes == "world" or R_world_contact is None else R_world_contact

    def in_contact_axes(self, wrench: Array, R_world_axes: Array) -> Array:
        """Components of wrenches that the model has.

        Args:
            wrench: (..., 6) world axes, N and N·m.
            R_world_axes: (..., 3, 3) see `contact_axes`.

        Returns:
            (..., m) contact axes.
        """
        if self.config.contact.axes != "world":
            parts = wrench.reshape(*wrench.shape[:-1], 2, 3)
            wrench = np.einsum("...ij,...ki->...kj", R_world_axes, parts).reshape(wrench.shape)
        return wrench[..., list(AXES_OF_DIMENSION[self.m])] if self.m else wrench[..., :0]


def filled(values: Sequence[float], size: int) -> Array:
    """(size,) values, the last one repeated."""
    if size == 0:
        return np.zeros(0)
    if not all(math.isfinite(value) for value in values):
        raise ConfigError(f"contact stiffness and damping must be finite, got {list(values)}")
    return np.pad(np.array(values, dtype=np.float64), (0, size - len(values)), mode="edge")
