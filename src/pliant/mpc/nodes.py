"""Parameters of the nodes of a horizon as plain arrays: the same names and shapes as the compiled `Nodes`."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from pliant._mpc import Nodes
from pliant.spatial import Array


@dataclass
class PlainNodes:
    """Parameters of M nodes, for models that are evaluated in Python. See `pliant._mpc.Nodes` for shapes and units.

    A robot with a free base has nq ≠ nv: references of the state then have nq + nv entries, weights 2 nv.
    """

    state_reference: Array
    state_weight: Array
    control_reference: Array
    control_weight: Array
    torque_gravity_weight: Array
    control_gravity_weight: Array
    task_rotation: Array
    translation_reference: Array
    translation_weight: Array
    rotation_reference: Array
    rotation_weight: Array
    velocity_reference: Array
    velocity_weight: Array
    force_reference: Array
    force_weight: Array
    force_rate_weight: Array
    stiffness: Array
    damping: Array
    anchor_translation: Array
    anchor_rotation: Array
    contact_active: NDArray[np.bool_]
    torque_lower: Array
    torque_upper: Array
    force_lower: Array
    force_upper: Array
    friction: Array
    sliding_friction: Array

    @staticmethod
    def zeros(count: int, nq: int, nv: int, nu: int, m: int) -> PlainNodes:
        """Nodes without any cost or bound, in contact, of unit stiffness and damping."""

        def zero(*shape: int) -> Array:
            return np.zeros((count, *shape))

        return PlainNodes(
            state_reference=zero(nq + nv),
            state_weight=zero(2 * nv),
            control_reference=zero(nu),
            control_weight=zero(nu),
            torque_gravity_weight=zero(nu),
            control_gravity_weight=zero(nu),
            task_rotation=np.tile(np.eye(3), (count, 1, 1)),
            translation_reference=zero(3),
            translation_weight=zero(3),
            rotation_reference=np.tile(np.eye(3), (count, 1, 1)),
            rotation_weight=zero(3),
            velocity_reference=zero(6),
            velocity_weight=zero(6),
            force_reference=zero(m),
            force_weight=zero(m),
            force_rate_weight=zero(m),
            stiffness=np.ones((count, m)),
            damping=np.ones((count, m)),
            anchor_translation=zero(3),
            anchor_rotation=np.tile(np.eye(3), (count, 1, 1)),
            contact_active=np.ones(count, dtype=bool),
            torque_lower=np.full((count, nu), -np.inf),
            torque_upper=np.full((count, nu), np.inf),
            force_lower=np.full((count, m), -np.inf),
            force_upper=np.full((count, m), np.inf),
            friction=np.full(count, np.inf),
            sliding_friction=np.full(count, np.inf),
        )


NodeParameters = Nodes | PlainNodes
"""what is written into a horizon, compiled or plain; first axis: node"""

NAMES = tuple(field.name for field in fields(PlainNodes))


def copy_nodes(source: NodeParameters, target: NodeParameters, rows: slice = slice(None)) -> None:
    """Copies parameters of nodes, compiled or plain, into others. `rows` picks nodes of the source."""
    for name in NAMES:
        getattr(target, name)[...] = getattr(source, name)[rows]
