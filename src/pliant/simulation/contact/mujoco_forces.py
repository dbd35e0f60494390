"""Contact forces of MuJoCo's own law."""

from __future__ import annotations

from collections.abc import Mapping

import mujoco
import numpy as np

from pliant.spatial import Array, cross


def contact_wrenches(
    model: mujoco.MjModel, data: mujoco.MjData, frames: Mapping[int, str], sites: Mapping[str, int]
) -> tuple[dict[str, Array], frozenset[str]]:
    """Sums the contact forces on every contact frame.

    Args:
        model: compiled.
        data: after a step.
        frames: geom → the frame at which its contact counts.
        sites: frame → its site.

    Returns:
        Frame → (6,) wrench at its origin in world axes, zero without contact; the frames in contact.
    """
    wrenches = {frame: np.zeros(6) for frame in frames.values()}
    touching: set[str] = set()
    local = np.zeros(6)
    for index in range(data.ncon):
        contact = data.contact[index]
        for geom, sign in ((int(contact.geom[0]), -1.0), (int(contact.geom[1]), 1.0)):
            frame = frames.get(geom)
            if frame is None:
                continue
            mujoco.mj_contactForce(model, data, index, local)
            force = sign * (contact.frame.reshape(3, 3).T @ local[:3])
            lever = contact.pos - data.site_xpos[sites[frame]]
            wrenches[frame] += np.concatenate([force, cross(lever, force)])
            touching.add(frame)
    return wrenches, frozenset(touching)
