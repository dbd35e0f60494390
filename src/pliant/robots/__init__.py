"""The catalogue of robots. Pliant's own robots are package data; others need example-robot-data or
robot_descriptions."""

from __future__ import annotations

import importlib
import importlib.util
from pathlib import Path

from pliant.errors import MissingExtraError, RobotError, options
from pliant.lazy import make_callable
from pliant.robots.catalogue import CATALOGUE as CATALOGUE
from pliant.robots.catalogue import CatalogueEntry as CatalogueEntry

_HERE = Path(__file__).parent


def locate(source: str) -> Path:
    """The file of a catalogue name or of a path.

    Args:
        source: catalogue name, name of a robot_descriptions module (`panda_description`), or path.

    Raises:
        RobotError: neither a name nor a file.
        MissingExtraError: a catalogue robot whose data is not installed.
    """
    entry = CATALOGUE.get(source)
    if entry is None:
        return _locate_file(source)
    if entry.own:
        return _HERE / entry.file
    if entry.package == "robot_descriptions":
        if importlib.util.find_spec("robot_descriptions") is None:
            raise MissingExtraError(f"robot {source!r} needs robot_descriptions: pip install robot_descriptions")
        return _from_robot_descriptions(entry.file)
    folder = _example_robot_data()
    if folder is None:
        raise MissingExtraError(f"robot {source!r} needs example-robot-data: pip install 'pliant[robots]'")
    path = folder / entry.file
    if not path.is_file():
        raise RobotError(f"robot {source!r}: the installed example-robot-data has no {entry.file}")
    return path


def is_available(entry: CatalogueEntry) -> bool:
    """Whether the files of a catalogue robot are installed (of robot_descriptions: whether it can fetch them)."""
    if entry.package == "robot_descriptions":
        return importlib.util.find_spec("robot_descriptions") is not None
    folder = _HERE if entry.own else _example_robot_data()
    return folder is not None and (folder / entry.file).is_file()


def _locate_file(source: str) -> Path:
    try:
        path = Path(source).expanduser()
        found, folder, other = path.is_file(), path.is_dir(), path.exists()
    except (OSError, RuntimeError) as error:  # RuntimeError: a user who does not exist
        why = (error.strerror if isinstance(error, OSError) else None) or str(error)
        raise RobotError(f"robot {source[:80]!r} cannot be read: {why}; {options(CATALOGUE)}") from None
    if found:
        return path
    if other and not folder:
        raise RobotError(f"{source} is not a regular file; a robot is a URDF or MJCF file; {options(CATALOGUE)}")
    if folder:
        raise RobotError(
            f"{source} is a folder; a robot is a URDF or MJCF file, or one of the names; {options(CATALOGUE)}"
        )
    if source.endswith("_description") and importlib.util.find_spec("robot_descriptions") is not None:
        return _from_robot_descriptions(source)
    if path.suffix or "/" in source:
        raise RobotError(f"robot file {source} does not exist")
    raise RobotError(f"no robot named {source!r} and no such file; {options(CATALOGUE, source)}")


def _from_robot_descriptions(source: str) -> Path:
    try:
        module = importlib.import_module(f"robot_descriptions.{source}")
    except ImportError as error:
        raise RobotError(f"robot_descriptions has no module {source!r}") from error
    path = getattr(module, "URDF_PATH", None) or getattr(module, "MJCF_PATH", None)
    if path is None:
        raise RobotError(f"robot_descriptions.{source} has neither a URDF nor an MJCF")
    return Path(str(path))


def _example_robot_data() -> Path | None:
    """Folder of example-robot-data's robots, found without importing it (its package imports a viewer)."""
    spec = importlib.util.find_spec("example_robot_data")
    if spec is None or not spec.submodule_search_locations:
        return None
    for base in Path(next(iter(spec.submodule_search_locations))).parents:
        folder = base / "share" / "example-robot-data" / "robots"
        if folder.is_dir():
            return folder
    return None


make_callable(__name__, "pliant.robots.catalogue", "robots")
