"""Checks of a URDF's tree: names, parents, types, couplings. Each fault is one sentence with the remedy."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection
from pathlib import Path
from xml.etree.ElementTree import Element

from pliant.errors import RobotError, options
from pliant.robots.description import lock_hint

_MOVING = ("revolute", "continuous", "prismatic")
_KNOWN = (*_MOVING, "fixed", "floating", "planar")


def check_tree(root: Element, path: Path, locked: Collection[str]) -> None:
    """Raises RobotError for a URDF that is a template, or whose links and joints do not make a tree of one-axis
    joints."""
    _check_template(root, path)
    links, joints = root.findall("link"), root.findall("joint")
    if not links:
        raise RobotError(f"{path}: <robot> has no <link>; a URDF needs at least two links and a joint between them")
    for kind, elements in (("link", links), ("joint", joints)):
        for element in elements:
            if not element.get("name"):
                raise RobotError(f"{path}: a <{kind}> has no name; every {kind} needs one")
        twice = [name for name, count in Counter(e.get("name") for e in elements).items() if count > 1]
        if twice:
            raise RobotError(f"{path}: two {kind}s are called {twice[0]!r}; give each {kind} a name of its own")
    names = [str(link.get("name")) for link in links]
    for joint in joints:
        _check_joint(joint, path, names, locked)
    _check_shape(joints, names, path)


def _check_template(root: Element, path: Path) -> None:
    for element in root.iter():
        values = [str(element.tag), *element.attrib.values()]
        if any("ros.org/wiki/xacro" in v or "wiki.ros.org/xacro" in v or v.startswith("xacro:") for v in values) or any(
            "${" in v or "$(" in v for v in element.attrib.values()
        ):
            raise RobotError(
                f"{path} is a xacro template, not yet a URDF; expand it first: xacro {path.name} > robot.urdf"
            )


def _check_joint(joint: Element, path: Path, links: list[str], locked: Collection[str]) -> None:
    name, kind = str(joint.get("name")), joint.get("type")
    if kind not in _KNOWN:
        told = "has no type" if kind is None else f"is of type {kind!r}"
        raise RobotError(f"{path}: joint {name!r} {told}; {options(_KNOWN, kind)}")
    for end in ("parent", "child"):
        element = joint.find(end)
        link = None if element is None else element.get("link")
        if link not in links:
            got = "no" if link is None else f"the unknown link {link!r} as its"
            raise RobotError(f"{path}: joint {name!r} has {got} {end}; {options(links, link)}")
    if name in locked:
        return
    if kind in ("floating", "planar"):
        raise RobotError(
            f"{path}: joint {name!r} is {kind}; joints must be revolute, continuous or prismatic, or be locked where"
            f" the file puts them: {lock_hint(name)}"
        )
    mimic = joint.find("mimic")
    if mimic is not None and kind in _MOVING:
        raise RobotError(
            f"{path}: joint {name!r} follows joint {mimic.get('joint', '')!r} (mimic), and coupled joints are not"
            f" simulated; lock it: {lock_hint(name)}"
        )


def _check_shape(joints: list[Element], links: list[str], path: Path) -> None:
    """A tree has one root and one joint above each other link."""
    above: dict[str, str] = {}
    for joint in joints:
        name, child = str(joint.get("name")), _end(joint, "child")
        if child in above:
            raise RobotError(
                f"{path}: link {child!r} hangs on two joints, {above[child]!r} and {name!r}: a closed loop; a URDF is a"
                " tree, remove one of them"
            )
        above[child] = name
    roots = [link for link in links if link not in above]
    if not roots:
        raise RobotError(
            f"{path}: every link hangs on a joint, so that nothing is the base; remove a joint of the loop"
        )
    if len(roots) > 1:
        raise RobotError(
            f"{path}: {', '.join(map(repr, roots))} all hang on nothing; one link may be the base, connect the others"
            " to it with joints"
        )


def _end(joint: Element, which: str) -> str:
    element = joint.find(which)
    assert element is not None
    return str(element.get("link"))
