"""The mass matrix as a whole matrix."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from pliant.spatial import Array


def mass_matrix(model: pin.Model, data: pin.Data, q: Array) -> Array:
    """M(q) (n, n), rotor inertia included, kg m² (kg for prismatic joints). Both triangles are filled."""
    upper = np.triu(np.asarray(pin.crba(model, data, q)))  # pinocchio does not promise the lower one
    return upper + np.triu(upper, 1).T
