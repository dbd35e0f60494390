"""Reads a robot file, URDF or MJCF."""

from __future__ import annotations

from collections.abc import Collection
from pathlib import Path
from xml.etree import ElementTree

from pliant.errors import OutputError, RobotError
from pliant.files import read_file
from pliant.robots.description import Description
from pliant.robots.urdf import read_urdf

_LARGEST = 1e8  # bytes
_REMEDIES = {
    "sdf": "an SDF; convert it to a URDF or an MJCF first",
    "html": "a web page; download the file itself (the page's 'raw' link)",
    "mujocoinclude": "a part that an MJCF includes; load the MJCF itself",
}


def read_description(path: Path, locked: Collection[str]) -> Description:
    """Reads a URDF or an MJCF.

    Args:
        path: the file.
        locked: names of joints that will not move; they may be of any type.

    Raises:
        RobotError: the file cannot be read, is neither of the two, or describes no robot that can be represented.
    """
    root = _parse(path)
    tag = root.tag.rsplit("}", 1)[-1]
    namespace = root.tag.removesuffix(tag)
    for element in root.iter():
        element.tag = element.tag.removeprefix(namespace)
    if tag == "robot":
        return read_urdf(path, root, locked)
    if tag == "mujoco":
        from pliant.robots.mjcf import read_mjcf  # here: a URDF needs no MuJoCo, which takes a moment to import

        return read_mjcf(path, locked)
    known = f"it is {_REMEDIES[tag.lower()]}" if tag.lower() in _REMEDIES else f"its root element is <{tag}>"
    raise RobotError(f"{path} must be a URDF (<robot>) or an MJCF (<mujoco>); {known}")


def _parse(path: Path) -> ElementTree.Element:
    try:
        content = read_file(path, _LARGEST)
        if not content:
            raise RobotError(f"{path} is empty; a robot file is a URDF or an MJCF")
        return ElementTree.fromstring(content)
    except ElementTree.ParseError as error:
        raise RobotError(f"{path} is not XML ({error}); a robot file is a URDF or an MJCF") from error
    except (UnicodeError, ValueError, LookupError) as error:
        raise RobotError(f"{path} is not readable text ({error}); save it as UTF-8") from error
    except OutputError as error:
        raise RobotError(str(error)) from None
