"""Reads a URDF: the text is checked first, for clear messages; then pinocchio builds the model."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable, Collection, Generator
from contextlib import contextmanager
from pathlib import Path
from xml.etree import ElementTree

import pinocchio as pin

from pliant.errors import RobotError
from pliant.robots.description import Description, require_movement, set_limits
from pliant.robots.urdf_checks import check_tree
from pliant.robots.urdf_numbers import check_numbers
from pliant.robots.urdf_repairs import repair


def read_urdf(path: Path, root: ElementTree.Element, locked: Collection[str]) -> Description:
    """Reads a URDF of a robot on a fixed base.

    Args:
        path: the file, for messages and to find its meshes.
        root: its parsed content; changed on the way.
        locked: joints that will not move. Those among them that are neither revolute nor prismatic (floating, planar)
            stay where the file puts them; a mimic joint among them follows nothing.

    Raises:
        RobotError: the file contradicts itself or holds something that is not supported; the sentence names it.
    """
    check_tree(root, path, locked)
    notes = check_numbers(root, path, locked)
    repairs = repair(root, path, locked)
    text = ElementTree.tostring(root, encoding="unicode")
    with _captured() as said:
        try:
            model = pin.buildModelFromXML(text)
        except (ValueError, RuntimeError, IndexError) as error:
            reason = said() or str(error).strip().splitlines()[-1]
            raise RobotError(f"{path} could not be read as a URDF: the parser says «{reason}»") from error
        visual = _visual(model, text, path)
    drawn = [] if visual is not None else ["the shapes could not be read: it is drawn as a stick figure"]
    require_movement(model, path)
    for name, (lower, upper) in repairs.limits.items():
        set_limits(model, model.joints[model.getJointId(name)].idx_q, lower, upper)
    return Description(model, visual, welded=frozenset(repairs.welded), notes=(*notes, *repairs.notes, *drawn))


def _visual(model: pin.Model, text: str, path: Path) -> pin.GeometryModel | None:
    folders = [str(folder) for folder in path.resolve().parents]
    try:
        return pin.buildGeomFromUrdfString(model, text, pin.GeometryType.VISUAL, package_dirs=folders)
    except (ValueError, RuntimeError):
        return None  # missing meshes: the robot still works, drawn as a stick figure


@contextmanager
def _captured() -> Generator[Callable[[], str], None, None]:
    """Keeps what the C++ parser writes to the process's standard error; yields a function that returns it."""
    with tempfile.TemporaryFile() as file:
        try:
            kept = os.dup(2)
        except OSError:  # a process without standard error
            yield lambda: ""
            return
        os.dup2(file.fileno(), 2)

        def said() -> str:
            file.seek(0)
            lines = file.read().decode("utf-8", "replace").splitlines()
            known = [line.split("Error:")[-1].strip() for line in lines if "Error" in line]
            return "; ".join(dict.fromkeys(known))

        try:
            yield said
        finally:
            os.dup2(kept, 2)
            os.close(kept)
