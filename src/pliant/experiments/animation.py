"""A log as an animated picture."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from pliant.errors import ConfigError, OutputError
from pliant.experiments.drawn import drawn_log
from pliant.simulation.snapshot import Arrow, Camera, Path3, Snapshot, render
from pliant.spatial import Array
from pliant.telemetry.log import Log
from pliant.telemetry.scene_topics import DrawnScene

ENDINGS = (".webp", ".gif")
_REFERENCE, _TRACE, _FORCE = (0.35, 0.55, 0.85, 1.0), (0.95, 0.45, 0.10, 1.0), (0.76, 0.18, 0.18, 1.0)
_METRES_PER_NEWTON = 0.004
_SHOWN = 0.05  # N; smaller forces have no arrow
_POINTS = 400  # approximate number of points of a path


def animate(log: Log, path: Path, *, seconds: float = 6.0, rate: float = 12.0, width: int = 480) -> Path:
    """Animates the robot, its scene, the reference and actual path, and the contact force; the whole run in a few
    seconds.

    Args:
        log: of a simulated run.
        path: the picture, .webp or .gif.
        seconds: duration of the animation.
        rate: pictures per second.
        width: pixels; the height is three quarters of it.

    Returns:
        The file.

    Raises:
        ConfigError: another file type, or a duration, rate or width out of range.
        OutputError: the log holds no motion, this machine cannot render, or the file cannot be written.
        RobotError: the robot of the log is not here.
    """
    if path.suffix.lower() not in ENDINGS:
        raise ConfigError(f"an animated picture ends in {' or '.join(ENDINGS)}, got {path.name!r}")
    count = round(seconds * rate) if np.isfinite(seconds * rate) else 0
    if not (2 <= count <= 600 and 64 <= width <= 1920 and rate <= 50.0):
        raise ConfigError(
            "an animated picture has 2 to 600 pictures, at most 50 /s, 64 to 1920 pixels wide, got"
            f" {seconds:g} s at {rate:g} /s, {width} wide"
        )
    if "truth/q" not in log or len(log["truth/q"]) < 2:
        raise OutputError(f"{log.source} has no motion that could be drawn: there is no channel 'truth/q'")
    drawn, _, _ = drawn_log(log)
    moments = np.linspace(0, len(log["truth/q"]) - 1, count).astype(int)
    frame = _frame(log)
    shots = [_shot(log, drawn, frame, int(moment)) for moment in moments]
    pictures = render(drawn.model, shots, _camera(log, frame), width=width, height=3 * width // 4)
    if pictures is None:
        raise OutputError("this machine renders no pictures: neither EGL nor OSMesa works (`pliant doctor`)")
    _write(path, pictures, rate)
    return path


def _frame(log: Log) -> str | None:
    """The first frame with a reference and a true position."""
    names = [name.split("/")[1] for name in log.matching("/position") if name.startswith("reference/")]
    return next((name for name in names if f"truth/{name}/position" in log), None)


def _camera(log: Log, frame: str | None) -> Camera:
    """View from the front right, so that the base and the path of the tool are visible."""
    if frame is None:
        return Camera()
    place = log[f"truth/{frame}/position"]
    middle = 0.5 * (place.max(axis=0) + place.min(axis=0))
    x, y, z = (float(entry) for entry in 0.75 * middle)
    return Camera(
        (x, y, z + 0.12), distance=max(2.0 * float(np.linalg.norm(middle)), 0.9), azimuth=128.0, elevation=-18.0
    )


def _shot(log: Log, drawn: DrawnScene, frame: str | None, moment: int) -> Snapshot:
    qpos = np.array(drawn.model.qpos0)
    qpos[: drawn.joints] = log["truth/q"][moment]
    for name in (one for one in log.channels if one.startswith("truth/objects/")):
        start = int(drawn.model.joint(name.split("/")[2]).qposadr[0])
        poses = log[name]
        qpos[start : start + 7] = poses[min(moment, len(poses) - 1)]
    if frame is None:
        return Snapshot(qpos)
    place = log[f"truth/{frame}/position"]
    paths = [Path3(_thinned(log[f"reference/{frame}/position"]), _REFERENCE, 0.002)]
    if moment > 1:
        paths.append(Path3(_thinned(place[: moment + 1]), _TRACE, 0.003))
    force = f"truth/{frame}/wrench"
    pressed = log[force][min(moment, len(log[force]) - 1), :3] if force in log else np.zeros(3)
    shown = float(np.linalg.norm(pressed)) > _SHOWN
    arrows = (Arrow(place[moment], _METRES_PER_NEWTON * pressed, _FORCE),) if shown else ()
    return Snapshot(qpos, tuple(paths), arrows)


def _thinned(points: Array) -> Array:
    return points[:: 1 + len(points) // _POINTS]


def _write(path: Path, pictures: list[Array], rate: float) -> None:
    from PIL import Image

    frames = [Image.fromarray(picture.astype(np.uint8)) for picture in pictures]
    if path.suffix.lower() == ".gif":
        frames = [frame.quantize(64) for frame in frames]
    try:
        frames[0].save(path, save_all=True, append_images=frames[1:], duration=round(1e3 / rate), loop=0, quality=60)
    except OSError as error:
        raise OutputError(f"{path} cannot be written: {error.strerror or error}") from error
