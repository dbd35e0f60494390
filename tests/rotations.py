"""Mathematics of rotations that only tests need."""

from __future__ import annotations

import numpy.typing as npt
import pinocchio as pin

from pliant.spatial import Array, exp3


def left_jacobian_inverse(e: npt.ArrayLike) -> Array:
    """Inverse of the left Jacobian of SO(3): `d log = J_l⁻¹(e) ω` for a rotation `exp(e)` that turns with ω in world
    axes. Args: e (3,) rad, shorter than 2π. Returns: (3, 3), the transpose of pinocchio's, which is the right one."""
    return pin.Jlog3(exp3(e)).T
