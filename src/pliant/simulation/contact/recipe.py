"""Contact stiffness and damping in N/m and N s/m, given to MuJoCo.

MuJoCo's negative `solref` is a stiffness per unit of the constraint's inverse inertia. With a constant impedance d,
`solref = (−K Â (1−d), −B Â (1−d))` makes the normal force exactly `K p + B ṗ`, Â being the sum of the two bodies'
translational `invweight0`. d has to be small, so that the constraint's own compliance dominates its inertia.
"""

from __future__ import annotations

import mujoco
import numpy as np

from pliant.errors import ConfigError
from pliant.simulation.surface import Surface

_IMPEDANCE = 1e-4
_TANGENTIAL_DAMPING = 300.0  # N s/m of viscosity below the friction limit; with more, a light tool chatters


def add_pair(spec: mujoco.MjSpec, name: str, geom_1: str, geom_2: str) -> None:
    """Adds a contact pair of two geoms; `apply_surface` sets its parameters once the model is compiled."""
    pair = spec.add_pair(name=name, geomname1=geom_1, geomname2=geom_2)
    pair.condim = 3
    pair.solimp = [_IMPEDANCE, _IMPEDANCE, 1e-3, 0.5, 2.0]
    pair.solref = [-1.0, -1.0]
    pair.solreffriction = [-1.0, -1.0]


def apply_surface(model: mujoco.MjModel, pair_name: str, surface: Surface) -> None:
    """Sets a pair's stiffness, damping and friction.

    Args:
        model: compiled; `timestep` set.
        pair_name: of the pair.
        surface: contact properties of the two geoms.

    Raises:
        ConfigError: the physics step is too long for that stiffness and damping with the lighter of the two bodies.
    """
    pair = model.pair(pair_name).id
    bodies = [model.geom_bodyid[model.pair_geom1[pair]], model.geom_bodyid[model.pair_geom2[pair]]]
    A_hat = float(sum(model.body_invweight0[body, 0] for body in bodies))
    dt = float(model.opt.timestep)
    if A_hat * (surface.stiffness * dt**2 + 2.0 * surface.damping * dt) >= 4.0:
        raise ConfigError(
            f"contact {pair_name!r}: (K dt² + 2 B dt)/m must stay below 4, got K = {surface.stiffness:g} N/m, B ="
            f" {surface.damping:g} N s/m, m = {1.0 / A_hat:.3g} kg at a physics step of {dt:g} s;"
            " shorten the step or use contact"
            ' = "explicit"'
        )
    scale = A_hat * (1.0 - _IMPEDANCE)
    model.pair_solref[pair] = [-surface.stiffness * scale, -surface.damping * scale]
    tangential = min(_TANGENTIAL_DAMPING, 1.0 / (dt * A_hat))
    model.pair_solreffriction[pair] = [0.0, -tangential * scale]
    model.pair_friction[pair] = np.array([surface.friction, surface.friction, 0.0, 0.0, 0.0]) + 1e-9
