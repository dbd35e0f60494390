"""Checks of a URDF's numbers: inertia, axes, limits, lengths. Impossible values are refused, unusual ones noted."""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np

from pliant.errors import RobotError

LONGEST = 20.0
"""m from one joint to the next; beyond that the file is in millimetres"""
WIDEST = 8.0 * math.pi
"""rad: a joint limit beyond four turns is in degrees"""
_TURN = 2.0 * math.pi + 0.01
"""rad: a joint that is placed beyond that was most likely turned in degrees"""
_NEGATIVE = 1e-6
"""kg m²: below that a negative moment of inertia is rounding"""
_VECTORS = {"xyz": 3, "rpy": 3}
_SIZES = {"box": {"size": 3}, "cylinder": {"radius": 1, "length": 1}, "sphere": {"radius": 1}}
_SIZES["capsule"] = _SIZES["cylinder"]


def check_numbers(root: Element, path: Path, locked: Collection[str]) -> list[str]:
    """Notes about a URDF's numbers. Raises RobotError for an impossible one."""
    notes: list[str] = []
    for link in root.findall("link"):
        where = f"{path}: link {link.get('name')!r}"
        for element in link.iter():
            _check_vectors(element, where)
        _check_inertial(link, where)
        notes += _drop_flat_shapes(link)
    for joint in root.findall("joint"):
        where = f"{path}: joint {joint.get('name')!r}"
        for element in joint.iter():
            _check_vectors(element, where)
        notes += _check_place(joint, where)
        if joint.get("type") in ("revolute", "continuous", "prismatic"):
            _check_axis(joint, where)
            lower, upper = _check_limit(joint, where)
            if lower == upper != 0.0 and joint.get("type") != "continuous" and joint.get("name") not in locked:
                raise RobotError(f"{where} cannot move: its limits are both {lower:g}; make it fixed, or widen them")
    return notes


def _numbers(text: str, count: int, where: str, what: str) -> Sequence[float]:
    try:
        values = [float(part) for part in text.split()]
    except ValueError:
        values = []
    if len(values) != count or not np.isfinite(values).all():
        comma = "; decimals need a point, not a comma" if "," in text else ""
        wanted = "a finite number" if count == 1 else f"{count} finite numbers"
        raise RobotError(f"{where} has {what}={text!r}, which must be {wanted}{comma}")
    return values


def _check_vectors(element: Element, where: str) -> None:
    for key, count in _VECTORS.items():
        text = element.get(key)
        if text is not None:
            _numbers(text, count, where, f"<{element.tag}> {key}")


def _check_inertial(link: Element, where: str) -> None:
    inertial = link.find("inertial")
    if inertial is None:
        return
    mass, tensor = inertial.find("mass"), inertial.find("inertia")
    if mass is None or tensor is None:
        raise RobotError(f"{where} has an <inertial> without <mass> or <inertia>; give both, or leave out <inertial>")
    kilograms = _numbers(mass.get("value", ""), 1, where, "mass value")[0]
    if kilograms < 0.0:
        raise RobotError(f"{where} has a mass of {kilograms:g} kg; a mass must not be negative")
    keys = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
    xx, yy, zz, xy, xz, yz = (_numbers(tensor.get(key, "0"), 1, where, f"inertia {key}")[0] for key in keys)
    least = float(np.linalg.eigvalsh(np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]))[0])
    if least < -_NEGATIVE:
        raise RobotError(
            f"{where} has an inertia with the principal moment {least:.3g} kg m²; moments of inertia must not be"
            " negative: check ixx … izz, and the signs of ixy, ixz, iyz"
        )


def _drop_flat_shapes(link: Element) -> list[str]:
    """Removes shapes that cannot be drawn, with a note."""
    notes: list[str] = []
    for kind in ("visual", "collision"):
        for shape in link.findall(kind):
            solid = next((e for e in shape.iter() if e.tag in _SIZES), None)
            if solid is None:
                continue
            wanted = _SIZES[solid.tag]
            if not all(_is_solid(solid.get(key, "").split(), count) for key, count in wanted.items()):
                told = ", ".join(f"{key} {solid.get(key, 'missing')!r}" for key in wanted)
                link.remove(shape)
                notes.append(
                    f"link {link.get('name')!r}: a {solid.tag} with {told} is not drawn; sizes must be above zero"
                )
    return notes


def _is_solid(sizes: Sequence[str], count: int) -> bool:
    try:
        return len(sizes) == count and all(float(size) > 0.0 for size in sizes)
    except ValueError:
        return False


def _check_place(joint: Element, where: str) -> list[str]:
    origin = joint.find("origin")
    xyz, rpy = (
        np.array([float(x) for x in (origin.get(key, "0 0 0") if origin is not None else "0 0 0").split()])
        for key in ("xyz", "rpy")
    )
    if np.linalg.norm(xyz) > LONGEST:
        raise RobotError(
            f"{where} lies {np.linalg.norm(xyz):.0f} m from the joint before it; lengths are in metres: divide by 1000"
            " if the file is in millimetres"
        )
    if np.abs(rpy).max() > _TURN:
        told = " ".join(f"{x:g}" for x in rpy)
        return [f"joint {joint.get('name')!r} is placed with rpy {told}, more than a turn; angles are in radians"]
    return []


def _check_axis(joint: Element, where: str) -> None:
    axis = joint.find("axis")
    if axis is None:
        return
    if axis.get("xyz") is None:
        raise RobotError(f'{where} has an <axis> without xyz; give the direction that it moves along: xyz="0 0 1"')
    if np.linalg.norm(_numbers(axis.get("xyz", ""), 3, where, "axis xyz")) < 1e-9:
        raise RobotError(f"{where} has the axis 0 0 0; give the direction that it moves along, for example 0 0 1")


def _check_limit(joint: Element, where: str) -> tuple[float, float]:
    """Lower and upper limit; 0 and 0 where there are none."""
    limit = joint.find("limit")
    kind = joint.get("type")
    if limit is None:
        if kind == "continuous":
            return 0.0, 0.0
        raise RobotError(f"{where} is {kind} and has no <limit>; add lower, upper, effort and velocity")
    for key, unit in (("effort", "N·m"), ("velocity", "rad/s")):
        if limit.get(key) is None:
            raise RobotError(
                f'{where} has a <limit> without {key}, which the format requires; add {key}="…" ({unit}), 0 if unknown'
            )
        if _numbers(limit.get(key, ""), 1, where, f"limit {key}")[0] < 0.0:
            raise RobotError(f"{where} has {key}={limit.get(key)}; a limit must not be negative, 0 means unknown")
    lower, upper = (_numbers(limit.get(key, "0"), 1, where, f"limit {key}")[0] for key in ("lower", "upper"))
    if kind != "continuous" and lower > upper:
        raise RobotError(f"{where} has its limits swapped: lower={lower:g} is above upper={upper:g}")
    if kind == "revolute" and max(abs(lower), abs(upper)) > WIDEST and upper - lower < 1e3:
        raise RobotError(
            f"{where} has limits from {lower:g} to {upper:g} rad, more than four turns; angles are in radians: multiply"
            f" by π/180 if the file is in degrees, or make the joint continuous"
        )
    return lower, upper
