"""Surfaces as the compiled estimators take them."""

from __future__ import annotations

import numpy.typing as npt

from pliant._estimation import Plane, PythonSurface, Surface
from pliant.surfaces import PlaneSurface, SurfaceGeometry


def surface_facing(normal: npt.ArrayLike | SurfaceGeometry) -> SurfaceGeometry:
    """A believed surface, or the plane through the origin with an outward normal (3,) of any length above zero.

    Raises:
        ConfigError: a normal without length.
    """
    return normal if isinstance(normal, SurfaceGeometry) else PlaneSurface.facing(normal)


def compiled_surface(surface: SurfaceGeometry) -> Surface:
    """A plane in C++; every other surface is asked in Python."""
    if type(surface) is PlaneSurface:
        return Plane(surface.origin.tolist(), surface.rotation[:, 2].tolist())
    return PythonSurface(surface.near)
