"""Where the surface of a part is: signed distance, normal, curvature, and charts in which patterns are drawn.

Plant, estimators, references and predictive controllers share these shapes; how a surface feels to the touch
(stiffness, damping, friction) is not part of them.
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
