"""Surfaces of parts: signed distance, normal, curvature, and charts for patterns.

Plant, estimators, references and predictive controllers share these shapes; contact properties (stiffness, damping,
friction) are not part of them.
"""

from pliant.surfaces.cylinder import CylinderSurface
from pliant.surfaces.edge import EdgeSurface
from pliant.surfaces.facets import FacetSurface
from pliant.surfaces.geometry import Nearest, SurfaceGeometry
from pliant.surfaces.hole import HoleSurface
from pliant.surfaces.mesh import MeshSurface
from pliant.surfaces.plane import PlaneSurface
from pliant.surfaces.sphere import SphereSurface

__all__ = [
    "CylinderSurface",
    "EdgeSurface",
    "FacetSurface",
    "HoleSurface",
    "MeshSurface",
    "Nearest",
    "PlaneSurface",
    "SphereSurface",
    "SurfaceGeometry",
]
