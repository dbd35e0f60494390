"""Renders the job in a folder. Runs as a process of its own (see snapshot.py) and imports nothing from pliant."""

import sys
from pathlib import Path

import mujoco
import numpy as np


def main(folder: Path) -> None:
    job = np.load(folder / "job.npz")
    model = mujoco.MjModel.from_binary_path(str(folder / "model.mjb"))
    width, height = (int(pixels) for pixels in job["size"])
    model.vis.global_.offwidth, model.vis.global_.offheight = width, height
    model.vis.headlight.ambient[:] = 0.38
    model.vis.headlight.diffuse[:] = 0.35
    model.vis.headlight.specular[:] = 0.1
    data = mujoco.MjData(model)
    pixels: list[np.ndarray] = []
    with mujoco.Renderer(model, height, width, max_geom=len(job["lines"]) + 2000) as renderer:
        for index, qpos in enumerate(job["qpos"]):
            data.qpos[:] = qpos
            mujoco.mj_forward(model, data)
            renderer.update_scene(data, _camera(job["camera"]), _options())
            _light_background(renderer)
            for line in job["lines"][job["lines"][:, 0] == index]:
                _draw(renderer.scene, line)
            pixels.append(_on_white(renderer))
    np.save(folder / "pixels.npy", np.array(pixels))


def _camera(values: np.ndarray) -> mujoco.MjvCamera:
    camera = mujoco.MjvCamera()
    camera.lookat[:] = values[:3]
    camera.distance, camera.azimuth, camera.elevation = values[3:]
    return camera


def _options() -> mujoco.MjvOption:
    options = mujoco.MjvOption()
    options.flags[mujoco.mjtVisFlag.mjVIS_CONTACTPOINT] = False
    return options


def _light_background(renderer: mujoco.Renderer) -> None:
    renderer.scene.flags[mujoco.mjtRndFlag.mjRND_SHADOW] = False
    renderer.scene.flags[mujoco.mjtRndFlag.mjRND_REFLECTION] = False
    renderer.scene.flags[mujoco.mjtRndFlag.mjRND_SKYBOX] = False


def _draw(scene: mujoco.MjvScene, line: np.ndarray) -> None:
    if scene.ngeom >= scene.maxgeom:
        return
    _, is_arrow, width = line[:3]
    kind = mujoco.mjtGeom.mjGEOM_ARROW if is_arrow else mujoco.mjtGeom.mjGEOM_CAPSULE
    geom = scene.geoms[scene.ngeom]
    mujoco.mjv_initGeom(geom, kind, np.zeros(3), np.zeros(3), np.eye(3).ravel(), line[9:13].astype(np.float32))
    mujoco.mjv_connector(geom, kind, width, line[3:6], line[6:9])
    scene.ngeom += 1


def _on_white(renderer: mujoco.Renderer) -> np.ndarray:
    """The picture with white in place of the empty background, which is black: depth tells which pixels are empty. Both
    are read from one drawing; the renderer's own methods would draw once for each."""
    context, height, width = renderer._mjr_context, renderer.height, renderer.width
    picture, depth = np.empty((height, width, 3), np.uint8), np.empty((height, width), np.float32)
    area = mujoco.MjrRect(0, 0, width, height)
    renderer._gl_context.make_current()
    mujoco.mjr_render(area, renderer.scene, context)
    mujoco.mjr_readPixels(picture, depth, area, context)
    picture[depth <= 0.0] = 255  # the far end of the map that MuJoCo reads
    return np.flipud(picture)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
