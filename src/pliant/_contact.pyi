"""Typed face of the compiled contact law (cpp/contact)."""

from typing import Any

import numpy as np
import numpy.typing as npt

from pliant.spatial import Array

BRISTLE_SIZE: int
"""doubles of state per contact point: deflection (3) m, friction coefficient, sliding (0 or 1)"""

RIM: int
"""contact points of each rim of a cylinder, and of a hole's mouth"""

MATERIAL: tuple[str, ...]
"""names of the numbers in `material`"""

class TriangleMesh:
    """Triangles, and which place of them is nearest to a point.

    Raises ValueError: arrays of another shape, no triangle, or one that names a vertex that there is not.
    """

    def __init__(self, vertices: Array, triangles: npt.NDArray[np.int32]) -> None:
        """vertices (nv, 3) m; triangles (nt, 3) int32, anticlockwise from outside, each with an area."""

    def nearest(self, points: Array) -> tuple[Array, Array, Array]:
        """Signed distance (k,) m, place (k, 3) m and outward normal (k, 3) for points (k, 3). A point whose nearest
        place is on the rim of an open shell is outside."""

class SampledMesh:
    """A mesh seen through samples of its distance, smooth within `band` m of it; farther away its triangles answer.

    Raises ValueError: arrays of another shape, or a step that is not above zero.
    """

    def __init__(self, mesh: TriangleMesh, low: Array, step: float, values: Array, band: float) -> None:
        """values (nx, ny, nz) m at low (3,) + step · (i, j, k)."""

    def nearest(self, points: Array) -> tuple[Array, Array, Array]:
        """Signed distance (k,) m, and place (k, 3) m and outward unit normal (k, 3) of the smooth surface, for points
        (k, 3)."""

class Solid:
    """A solid in closed form, in its own axes."""

    @staticmethod
    def hole(radius: float, depth: float, chamfer: float) -> Solid:
        """A block with a round hole along −z of its face z = 0, bevelled by 45° at the mouth; m. Raises ValueError:
        sizes that no hole has."""

    @staticmethod
    def edge(angle: float, rounding: float) -> Solid:
        """Two half planes that meet at a line along x, z = 0 towards −y and one that comes down; rad of the material,
        m. Raises ValueError: an angle that is not between 0 and π, or a rounding below zero."""

    def nearest(self, points: Array) -> tuple[Array, Array, Array]:
        """Signed distance (k,) m, and place (k, 3) m and outward unit normal (k, 3), for points (k, 3)."""

class ContactLoop:
    """Contacts of one MuJoCo model and data, and the loop of mj_step1, forces, mj_step2.

    `step1` and `step2` are the addresses of those functions in the loaded MuJoCo library. Arrays must be float64 and
    contiguous; `bristles`, `force`, `point` and `penetration` are written in place.
    """

    def __init__(self, model: Any, data: Any, step1: int, step2: int) -> None: ...
    def add_pair(
        self,
        geom_a: int,
        geom_b: int,
        material: Array,
        hollow: bool = False,
        form: SampledMesh | Solid | None = None,
        tool: bool = False,
        line: Array | None = None,
        places: Array | None = None,
    ) -> tuple[int, int]:
        """Adds a pair of geoms; material (8,) in the order of `ContactMaterial`. Returns its first slot and its number
        of slots. `hollow`: the material of the second, a sphere or a cylinder, is outside of it. `form`: the surface
        of the second, in its axes; None: its own shape. `tool`: the first is a cylinder or a box whose points share
        the material. `line` (2, 3), a point and a unit direction in the world, and `places` (k,) m along it: between
        them the material, then (k, 8), is linear, beyond the first and the last one it stays.

        Raises ValueError: an unknown geom, or shapes that are not supported in this order.
        """

    @property
    def slots(self) -> int:
        """Number of contact points of all pairs."""

    def evaluate(self, dt: float, push: Array, bristles: Array, force: Array, point: Array, penetration: Array) -> bool:
        """Forces in the present state: writes push (nbody, 6) plus contacts to xfrc_applied. False if one is not
        finite."""

    def advance(
        self, count: int, dt: float, push: Array, bristles: Array, force: Array, point: Array, penetration: Array
    ) -> int:
        """Makes `count` physics steps of `dt` s without the GIL. Returns how many were sound; fewer than `count` is a
        failure."""
