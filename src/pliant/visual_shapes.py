"""Visual shapes of a scene, and their poses at a configuration."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import mujoco
import numpy as np
import numpy.typing as npt

from pliant.spatial import Array, quaternion

Kind = Literal["sphere", "cylinder", "capsule", "box", "mesh"]

_KINDS: Mapping[int, Kind] = {
    int(mujoco.mjtGeom.mjGEOM_SPHERE): "sphere",
    int(mujoco.mjtGeom.mjGEOM_CYLINDER): "cylinder",
    int(mujoco.mjtGeom.mjGEOM_CAPSULE): "capsule",
    int(mujoco.mjtGeom.mjGEOM_BOX): "box",
    int(mujoco.mjtGeom.mjGEOM_MESH): "mesh",
}


@dataclass(frozen=True, slots=True)
class Look:
    """One shape, fixed to one body."""

    name: str
    body: int
    """number of the body; 0 is the world"""
    robot: bool
    """whether it belongs to the robot"""
    kind: Kind
    size: tuple[float, float, float]
    """m: radius; radius and half length; half edges"""
    position: tuple[float, float, float]
    """m, in the body's axes"""
    quaternion: tuple[float, float, float, float]
    """w, x, y, z"""
    rgba: tuple[float, float, float, float]
    vertices: npt.NDArray[np.float32] | None = None
    """(v, 3) m, of a mesh"""
    faces: npt.NDArray[np.int32] | None = None
    """(f, 3)"""


def looks_of(model: mujoco.MjModel, joints: int) -> tuple[Look, ...]:
    """Every visible shape of a model.

    Args:
        model: compiled, the robot's joints first.
        joints: how many of them are the robot's.
    """
    found: list[Look] = []
    for index in range(model.ngeom):
        kind = _KINDS.get(int(model.geom_type[index]))
        if kind is None or model.geom_rgba[index][3] == 0.0:
            continue  # the half-space itself: a plate shows it
        vertices, faces = _mesh(model, index) if kind == "mesh" else (None, None)
        body = int(model.geom_bodyid[index])
        found.append(
            Look(
                name=f"{index}",
                body=body,
                robot=_is_robot(model, body, joints) or model.geom(index).name.startswith("visual"),
                kind=kind,
                size=_three(model.geom_size[index]),
                position=_three(model.geom_pos[index]),
                quaternion=_four(model.geom_quat[index]),
                rgba=_four(model.geom_rgba[index]),
                vertices=vertices,
                faces=faces,
            )
        )
    return tuple(found)


class Poser:
    """Computes poses of bodies from joint angles and the poses of free things."""

    def __init__(self, model: mujoco.MjModel, joints: int) -> None:
        self.model, self._joints = model, joints
        self._data = mujoco.MjData(model)

    def bodies(self, q: Array, objects: Mapping[str, Array]) -> tuple[Array, Array]:
        """Positions (bodies, 3) in m and quaternions (bodies, 4) of all bodies.

        Args:
            q: (n,) rad.
            objects: thing → (7,) position and quaternion, of those that can move.
        """
        data = self._data
        data.qpos[: self._joints] = q
        for name, pose in objects.items():
            start = int(self.model.joint(name).qposadr[0])
            data.qpos[start : start + 7] = pose
        mujoco.mj_kinematics(self.model, data)
        return data.xpos.copy(), data.xquat.copy()

    def frame(self, name: str) -> Array | None:
        """Position (3,) in m of a frame at the configuration asked for last; None if there is no such frame."""
        placement = self.placement(name)
        return None if placement is None else placement[0]

    def placement(self, name: str) -> tuple[Array, Array] | None:
        """Position (3,) in m and quaternion (w, x, y, z) of a frame at the configuration asked for last, or None."""
        site = self.site(name)
        if site < 0:
            return None
        (position,), (rotation,) = self.sites([site])
        return position, quaternion(rotation)

    def site(self, name: str) -> int:
        """Number of a frame's site; -1: there is no such frame."""
        return mujoco.mj_name2id(self.model, mujoco.mjtObj.mjOBJ_SITE, name)

    def sites(self, numbers: Sequence[int]) -> tuple[Array, Array]:
        """Positions (k, 3) in m and rotations (k, 3, 3) of sites at the configuration asked for last."""
        data = self._data
        return data.site_xpos[numbers], data.site_xmat[numbers].reshape(-1, 3, 3)


def _is_robot(model: mujoco.MjModel, body: int, joints: int) -> bool:
    """Whether the joints that move a body are the robot's."""
    first = int(model.body_dofadr[body])
    while first < 0 and body > 0:  # welded to its parent
        body = int(model.body_parentid[body])
        first = int(model.body_dofadr[body])
    return 0 <= first < joints


def _mesh(model: mujoco.MjModel, geom: int) -> tuple[npt.NDArray[np.float32], npt.NDArray[np.int32]]:
    mesh = int(model.geom_dataid[geom])
    v, f = int(model.mesh_vertadr[mesh]), int(model.mesh_faceadr[mesh])
    vertices = model.mesh_vert[v : v + int(model.mesh_vertnum[mesh])]
    faces = model.mesh_face[f : f + int(model.mesh_facenum[mesh])]
    return np.array(vertices, dtype=np.float32), np.array(faces, dtype=np.int32)


def _three(values: Array) -> tuple[float, float, float]:
    a, b, c = (float(value) for value in values)
    return a, b, c


def _four(values: Array) -> tuple[float, float, float, float]:
    a, b, c, d = (float(value) for value in values)
    return a, b, c, d
