"""Base class of surfaces."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from typing import NamedTuple, Self

import numpy as np
import numpy.typing as npt

from pliant.errors import ConfigError, ShapeError
from pliant.spatial import Array, as_vector, exp3


class Nearest(NamedTuple):
    """The point of a surface that is nearest to a given point. World axes."""

    distance: float
    """m, negative inside the material"""
    normal: Array
    """(3,) outward unit normal there"""
    point: Array
    """(3,) m"""


@dataclass(frozen=True)
class SurfaceGeometry(ABC):
    """A smooth surface that bounds a solid.

    Raises:
        ConfigError: on construction, when the pose is not valid.
    """

    origin: Array
    """(3,) m, of the surface's own frame in the world"""
    rotation: Array
    """R_world_surface (3, 3)"""

    def __post_init__(self) -> None:
        object.__setattr__(self, "origin", as_vector(self.origin, 3, "the surface's origin"))
        R = np.array(self.rotation, dtype=np.float64)
        if R.shape != (3, 3):
            raise ShapeError(f"the surface's rotation must have shape (3, 3), got {R.shape}")
        if not (np.allclose(R @ R.T, np.eye(3), atol=1e-6) and np.linalg.det(R) > 0.0):
            raise ConfigError(f"the surface's rotation must be a rotation matrix, got {R.tolist()}")
        R.setflags(write=False)
        object.__setattr__(self, "rotation", R)

    @abstractmethod
    def near(self, point: npt.ArrayLike) -> Nearest:
        """Signed distance, normal and nearest place for a point (3,) m."""

    @abstractmethod
    def curvatures(self, point: npt.ArrayLike) -> tuple[float, float]:
        """Principal curvatures nearest to a point, 1/m, the larger size first; positive where the solid is convex."""

    @abstractmethod
    def top(self) -> Array:
        """(3,) m: default origin of patterns, the highest point of the surface if there is one."""

    @abstractmethod
    def chart(self, point: Array, along: Array, uv: Array) -> tuple[Array, Array]:
        """Places of the surface at lengths u and v from a place of it, measured on the surface.

        Args:
            point: (3,) m, a place of the surface.
            along: (3,) unit tangent there, the direction of u; v grows along normal × u.
            uv: (k, 2) m.

        Returns:
            Places (k, 3) m and outward normals (k, 3). The map is the exponential map of the surface: distances from
            `point` are exact; on a plane and a cylinder all lengths are.
        """

    def first_axis(self, normal: Array) -> Array:
        """(3,) unit vector, default direction of patterns: the surface's x axis, or its y axis where x is along the
        normal. Args: normal: (3,) of the place."""
        return self.rotation[:, 1 if abs(float(self.rotation[:, 0] @ normal)) > 0.95 else 0]

    @property
    def described(self) -> str:
        """A note about its representation; empty for a closed form."""
        return ""

    def normal(self, point: npt.ArrayLike) -> Array:
        """(3,) outward unit normal nearest to a point (3,) m."""
        return self.near(point).normal

    def moved(self, shift: npt.ArrayLike = 0.0, turn: npt.ArrayLike = 0.0, pivot: npt.ArrayLike | None = None) -> Self:
        """The same surface elsewhere.

        Args:
            shift: (3,) m, after the turn.
            turn: (3,) rad, rotation vector in world axes.
            pivot: (3,) m, the fixed point of the turn; None: the surface's origin.
        """
        R = exp3(as_vector(turn, 3, "turn"))
        about = self.origin if pivot is None else as_vector(pivot, 3, "pivot")
        origin = about + R @ (self.origin - about) + as_vector(shift, 3, "shift")
        return replace(self, origin=origin, rotation=R @ self.rotation)

    def tangent(self, point: npt.ArrayLike, direction: npt.ArrayLike) -> Array:
        """(3,) unit vector: a direction laid into the surface nearest to a point.

        Raises:
            ConfigError: the direction is along the normal.
        """
        n = self.normal(point)
        d = as_vector(direction, 3, "direction")
        flat = d - n * float(n @ d)
        length = float(np.linalg.norm(flat))
        if length < 1e-6 * max(float(np.linalg.norm(d)), 1e-12):
            raise ConfigError(f"direction {d.tolist()} is normal to the surface: give one that is tangent to it")
        return flat / length
