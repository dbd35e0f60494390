"""The shapes of a compiled MJCF, to draw."""

from __future__ import annotations

import coal
import mujoco
import numpy as np
import pinocchio as pin

from pliant.robots.mjcf_tree import Tree, pose

_HIDDEN = 3
"""geom groups from here on are not drawn by MuJoCo's viewer either"""


def visual_of(compiled: mujoco.MjModel, tree: Tree) -> pin.GeometryModel | None:
    """Shapes of the bodies that the robot consists of; None if there is none. What stands in the world is left out."""
    shown = pin.GeometryModel()
    for geom in range(compiled.ngeom):
        body = int(compiled.geom_bodyid[geom])
        shape = _shape(compiled, geom) if body > 0 and int(compiled.geom_group[geom]) < _HIDDEN else None
        if shape is None:
            continue
        joint, at = tree.bodies[body]
        where = at * pose(compiled.geom_pos[geom], compiled.geom_quat[geom])
        thing = pin.GeometryObject(f"geom{geom}", joint, tree.frames[body], where, shape)
        thing.meshColor = np.array(_colour(compiled, geom), dtype=np.float64)
        shown.addGeometryObject(thing)
    return shown if shown.ngeoms else None


def _colour(compiled: mujoco.MjModel, geom: int) -> np.ndarray[tuple[int, ...], np.dtype[np.float32]]:
    material = int(compiled.geom_matid[geom])
    return compiled.mat_rgba[material] if material >= 0 else compiled.geom_rgba[geom]


def _shape(compiled: mujoco.MjModel, geom: int) -> coal.CollisionGeometry | None:
    size, kind = compiled.geom_size[geom], mujoco.mjtGeom(int(compiled.geom_type[geom]))
    if kind == mujoco.mjtGeom.mjGEOM_SPHERE:
        return coal.Sphere(float(size[0]))
    if kind == mujoco.mjtGeom.mjGEOM_CAPSULE:
        return coal.Capsule(float(size[0]), 2.0 * float(size[1]))
    if kind == mujoco.mjtGeom.mjGEOM_CYLINDER:
        return coal.Cylinder(float(size[0]), 2.0 * float(size[1]))
    if kind == mujoco.mjtGeom.mjGEOM_BOX:
        return coal.Box(*(2.0 * float(s) for s in size))
    if kind == mujoco.mjtGeom.mjGEOM_MESH:
        return _mesh(compiled, int(compiled.geom_dataid[geom]))
    return None  # a shape that is not drawn; it plays no part in the physics


def _mesh(compiled: mujoco.MjModel, mesh: int) -> coal.CollisionGeometry:
    first, count = int(compiled.mesh_vertadr[mesh]), int(compiled.mesh_vertnum[mesh])
    start, faces = int(compiled.mesh_faceadr[mesh]), int(compiled.mesh_facenum[mesh])
    shape = coal.BVHModelOBBRSS()
    shape.beginModel(faces, count)
    shape.addVertices(np.array(compiled.mesh_vert[first : first + count], dtype=np.float64))
    shape.addTriangles(np.array(compiled.mesh_face[start : start + faces]))
    shape.endModel()
    return shape
