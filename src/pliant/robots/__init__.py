"""The catalogue of robots. Own ones are package data; others need example-robot-data or robot_descriptions."""

from __future__ import annotations

import importlib
import importlib.util
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from pliant.errors import MissingExtraError, RobotError, options

_HERE = Path(__file__).parent


@dataclass(frozen=True)
class CatalogueEntry:
    """A robot that can be loaded by name."""

    name: str
    description: str
    file: str
    """of pliant's own robots: URDF in this folder; of others: path below example-robot-data's robots"""
    own: bool = True
    rotor_inertia: float = 0.0
    """kg m² at each joint; URDF has no field for it"""
    home: tuple[float, ...] = ()
    """rad; empty: zero, or the nearest angle within the limits"""
    contact_radius: Mapping[str, float] = field(default_factory=dict)
    """frame → m"""


_ENTRIES = (
    CatalogueEntry(
        "lwr4",
        "KUKA LWR 4+, 7 joints; kinematics, torques and speeds of the arm. Its dynamics are assumed: uniform cylinders"
        " of 2.7 kg (four), 1.7, 1.6 and 0.3 kg, rotor inertia 0.05 kg m²",
        "lwr4.urdf",
        rotor_inertia=0.05,
        home=(0.0, 0.6, 0.0, -1.4, 0.0, 1.0, 0.0),
    ),
    CatalogueEntry(
        "iiwa14",
        "KUKA LBR iiwa 14 R820, 7 joints; identified inertial parameters",
        "iiwa14.urdf",
        home=(0.0, 1.0472, 0.0, -1.13446, 0.2, 0.7854, 0.0),
    ),
    CatalogueEntry(
        "leg3",
        "three-joint leg (hip roll, hip pitch, knee) of uniform 1 kg rods, base 0.5 m above the floor",
        "leg3.urdf",
        home=(0.0, 0.7, -1.4),
        contact_radius={"foot": 0.02},
    ),
    CatalogueEntry("panda", "Franka Emika Panda with its gripper", "panda_description/urdf/panda.urdf", own=False),
    CatalogueEntry("ur5", "Universal Robots UR5, 6 joints", "ur_description/urdf/ur5_robot.urdf", own=False),
    CatalogueEntry(
        "anymal",
        "ANYmal B quadruped on a fixed base, 12 joints",
        "anymal_b_simple_description/robots/anymal.urdf",
        own=False,
    ),
)

CATALOGUE: Mapping[str, CatalogueEntry] = {entry.name: entry for entry in _ENTRIES}
"""name → entry"""


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
    folder = _example_robot_data()
    if folder is None:
        raise MissingExtraError(f"robot {source!r} needs example-robot-data: pip install 'pliant[robots]'")
    path = folder / entry.file
    if not path.is_file():
        raise RobotError(f"robot {source!r}: the installed example-robot-data has no {entry.file}")
    return path


def is_available(entry: CatalogueEntry) -> bool:
    """Whether the files of a catalogue robot are installed."""
    folder = _HERE if entry.own else _example_robot_data()
    return folder is not None and (folder / entry.file).is_file()


def _locate_file(source: str) -> Path:
    path = Path(source).expanduser()
    if path.is_file():
        return path
    if path.is_dir():
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
