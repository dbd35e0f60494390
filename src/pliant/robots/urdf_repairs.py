"""Rewrites content of a URDF that pinocchio does not accept, with a note for each change."""

from __future__ import annotations

import os
from collections.abc import Collection
from dataclasses import dataclass, field
from pathlib import Path
from xml.etree.ElementTree import Element, SubElement

from pliant.robots.description import UNLIMITED, free_name

_FAR = "1e9"
_MOVING = ("revolute", "continuous", "prismatic")


@dataclass
class Repairs:
    """The changes."""

    limits: dict[str, tuple[float, float]] = field(default_factory=dict[str, tuple[float, float]])
    """joint → its limits, where the changed file does not hold them"""
    welded: list[str] = field(default_factory=list[str])
    """joints that became fixed ones"""
    notes: list[str] = field(default_factory=list[str])


def repair(root: Element, path: Path, locked: Collection[str]) -> Repairs:
    """Rewrites a checked URDF in place: unlimited joints, locked joints of any type, double names, mesh paths."""
    done = Repairs()
    if not root.get("name"):
        root.set("name", path.stem)
    unknown: dict[str, list[str]] = {"effort": [], "velocity": []}
    for joint in root.findall("joint"):
        _repair_joint(joint, locked, done)
        limit = joint.find("limit")
        if joint.get("type") in _MOVING and limit is not None:
            for key, names in unknown.items():
                if float(limit.get(key, "0")) == 0.0 and str(joint.get("name")) not in locked:
                    names.append(str(joint.get("name")))
    for key, what in (("effort", "no torque limit"), ("velocity", "no speed limit")):
        if unknown[key]:
            done.notes.append(f"{what} in the file ({key} is 0) for {', '.join(unknown[key])}: taken as unlimited")
    _separate_names(root, done)
    _find_meshes(root, path, done)
    return done


def _repair_joint(joint: Element, locked: Collection[str], done: Repairs) -> None:
    name, kind = str(joint.get("name")), joint.get("type")
    mimic = joint.find("mimic")
    if mimic is not None:
        joint.remove(mimic)
        if kind in _MOVING:
            done.notes.append(f"joint {name!r} is locked and no longer follows {mimic.get('joint')!r}")
    if kind in ("floating", "planar"):
        joint.set("type", "fixed")
        done.welded.append(name)
        done.notes.append(f"the {kind} joint {name!r} is locked where the file puts it")
        return
    limit = joint.find("limit")
    if kind == "continuous":
        joint.set("type", "revolute")
        limit = SubElement(joint, "limit", effort="0", velocity="0") if limit is None else limit
        limit.set("lower", f"-{_FAR}")
        limit.set("upper", _FAR)
        done.limits[name] = (-float("inf"), float("inf"))
        if name not in locked:
            done.notes.append(f"joint {name!r} is continuous: it turns without limits")
    elif kind in ("revolute", "prismatic") and limit is not None and name not in locked:
        lower, upper = float(limit.get("lower", "0")), float(limit.get("upper", "0"))
        if upper - lower > UNLIMITED:
            done.limits[name] = (-float("inf"), float("inf"))
        elif lower == upper == 0.0:
            done.limits[name] = (-float("inf"), float("inf"))
            done.notes.append(f"joint {name!r} has the limits 0 and 0: taken as unlimited")
        elif not lower <= 0.0 <= upper:
            done.notes.append(f"zero lies outside the limits of joint {name!r} ({lower:g} to {upper:g})")


def _separate_names(root: Element, done: Repairs) -> None:
    """A frame has one name: where a link and a joint share one, the joint between keeps it."""
    joints = {str(joint.get("name")): joint for joint in root.findall("joint")}
    links = {str(link.get("name")): link for link in root.findall("link")}
    for name in [name for name in links if name in joints]:
        joint, taken = joints[name], {*joints, *links}
        if joint.get("type") == "fixed":
            other = free_name(f"{name}_joint", taken)
            joint.set("name", other)
            joints[other] = joint
            done.notes.append(f"link and joint {name!r} share a name: the frame {name!r} is the link's")
            continue
        other = free_name(f"{name}_link", taken)
        links[name].set("name", other)
        links[other] = links[name]
        for element in root.iter():
            if element.tag in ("parent", "child") and element.get("link") == name:
                element.set("link", other)
        done.notes.append(f"link and joint {name!r} share a name: the link's frame is called {other!r}")


def _find_meshes(root: Element, path: Path, done: Repairs) -> None:
    """Makes mesh paths absolute; missing meshes are not drawn."""
    folders = [str(folder) for folder in path.resolve().parents] + os.environ.get("ROS_PACKAGE_PATH", "").split(":")
    missing: list[str] = []
    for link in root.findall("link"):
        for visual in link.findall("visual"):
            mesh = next(visual.iter("mesh"), None)
            if mesh is None:
                continue
            name = mesh.get("filename", "")
            found = _find(name, [folder for folder in folders if folder])
            if found is None:
                missing.append(name or "an empty name")
                link.remove(visual)
            else:
                mesh.set("filename", str(found))
    if missing:
        more = f" and {len(missing) - 1} more" if len(missing) > 1 else ""
        done.notes.append(f"missing meshes are not drawn: {missing[0]}{more}")


def _find(name: str, folders: list[str]) -> Path | None:
    rest = name.split("://", 1)[1] if "://" in name else name
    if not rest:
        return None
    places = [Path(rest)] if rest.startswith("/") else [Path(folder) / rest for folder in folders]
    return next((place for place in places if place.is_file()), None)
