"""Assembles a robot from a name or a file: locked joints, home, flange and elbow."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from pliant.errors import ConfigError, options
from pliant.robots import CATALOGUE, CatalogueEntry, locate
from pliant.robots.chain import arm_of
from pliant.robots.description import Description
from pliant.robots.home import bent_home, zero_home
from pliant.robots.inertia import check_inertia, small_inertia
from pliant.robots.known_rotors import RULE, Rotors
from pliant.robots.locking import lock
from pliant.robots.reading import read_description
from pliant.robots.rotors import set_rotors
from pliant.spatial import Array


@dataclass
class Assembly:
    """What a robot consists of; its fields are those of `Robot`."""

    name: str
    model: pin.Model
    visual: pin.GeometryModel | None
    home: Array
    source: str
    contact_radius: Mapping[str, float]
    home_from: str
    rotors_from: str
    notes: tuple[str, ...]
    faults: tuple[str, ...] = ()


def assemble(
    source: str,
    locked: Mapping[str, float] | None,
    home: npt.ArrayLike | str | None,
    rotors: Rotors | None,
) -> Assembly:
    """Reads a robot and chooses what its file does not define. Arguments and errors: those of `Robot.load`."""
    entry = CATALOGUE.get(source)
    path = locate(source)
    standing = entry.locked if entry is not None else {}
    locks = standing if locked is None else {**standing, **locked} if locked else {}
    description = read_description(path, locks)
    robot = _whole(description, entry, path, home if isinstance(home, str) else None)
    robot.rotors_from = _settle_rotors(robot.model, entry, rotors)
    joints = {name: angle for name, angle in locks.items() if name not in description.welded}
    if joints:
        robot.model, robot.visual, robot.home = lock(robot.name, robot.model, robot.visual, robot.home, joints)
    notes, robot.faults = check_inertia(robot.model, path)
    robot.notes += tuple(notes)
    if entry is not None and entry.home:  # zero is then not needed
        robot.notes = tuple(note for note in robot.notes if not note.startswith("zero lies outside"))
    _add_arm_frames(robot, entry)
    _settle_home(robot, None if isinstance(home, str) else home)
    if not robot.faults:
        robot.notes += tuple(small_inertia(robot.model, robot.home))
    return robot


def _whole(description: Description, entry: CatalogueEntry | None, path: Path, keyframe: str | None) -> Assembly:
    """The robot as its file has it, all joints free."""
    home, told, notes = _stated_home(description, entry, path, keyframe)
    return Assembly(
        name=entry.name if entry is not None else path.stem,
        model=description.model,
        visual=description.visual,
        home=home,
        source=str(path),
        contact_radius=dict(entry.contact_radius) if entry is not None else {},
        home_from=told,
        rotors_from="",
        notes=(*description.notes, *notes),
    )


def _settle_rotors(model: pin.Model, entry: CatalogueEntry | None, asked: Rotors | None) -> str:
    """Sets the motors' inertia. Returns its source; "" if none is given."""
    if asked is not None:
        set_rotors(model, asked)
        return RULE if asked == "assumed" else "argument"
    if entry is not None and entry.rotors is not None:
        set_rotors(model, entry.rotors)
        return f"catalogue: {entry.rotors_from}"
    return "file" if np.any(np.array(model.armature) > 0.0) else ""


def _stated_home(
    description: Description, entry: CatalogueEntry | None, path: Path, keyframe: str | None
) -> tuple[Array, str, list[str]]:
    """Home of all joints, its source ("" if none is given), and notes."""
    model, homes = description.model, description.homes
    if keyframe is not None and keyframe not in homes:
        raise ConfigError(f"{path} has no keyframe {keyframe!r} to be the home; {options(homes, keyframe)}")
    if keyframe is None and entry is not None and entry.home:
        return np.array(entry.home, dtype=np.float64), "catalogue", []
    chosen = keyframe if keyframe is not None else next((k for k in ("home", *homes) if k in homes), None)
    if chosen is None:
        return zero_home(model), "", []
    home, told = homes[chosen], f"keyframe {chosen!r} of the file"
    outside = np.flatnonzero((home < np.array(model.lowerPositionLimit)) | (home > np.array(model.upperPositionLimit)))
    names = ", ".join(model.names[1 + int(i)] for i in outside)
    return home, told, [f"{told}, the home, lies outside the limits of {names}"] if names else []


def _add_arm_frames(robot: Assembly, entry: CatalogueEntry | None) -> None:
    """Frames `flange` and `elbow` for an arm whose file has none of that name."""
    arm = None if entry is not None and entry.own else arm_of(robot.model)
    if arm is None:
        return
    model = robot.model
    if not model.existFrame("flange"):
        stated = entry is not None and bool(entry.flange)
        at = model.getFrameId(entry.flange) if entry is not None and stated else arm.flange
        frame = model.frames[at]
        model.addFrame(pin.Frame("flange", frame.parentJoint, at, frame.placement, pin.FrameType.OP_FRAME))
        if not stated:
            robot.notes += (f"the frame 'flange' is taken to be {frame.name!r}, the end of the arm",)
    if not model.existFrame("elbow") and arm.elbow is not None:
        joint, place = arm.elbow
        above = model.getFrameId(model.names[joint])
        model.addFrame(pin.Frame("elbow", joint, above, place, pin.FrameType.OP_FRAME))
        after = next(model.names[j] for j in arm.joints if model.parents[j] == joint)
        robot.notes += (
            f"the frame 'elbow' is taken to be at joint {after!r}, which splits the arm's length most evenly",
        )


def _settle_home(robot: Assembly, home: npt.ArrayLike | None) -> None:
    if home is not None:
        robot.home, robot.home_from = _checked(robot, home), "argument"
    elif not robot.home_from:
        arm = arm_of(robot.model)
        if arm is None:
            robot.home, robot.home_from = zero_home(robot.model), "zero, or the nearest angle within the limits"
            return
        robot.home, down = bent_home(robot.model, arm)
        robot.home_from = f"searched: bent, away from singularities{', flange down' if down else ''}"
        aim = "" if down else ", no pose with the flange down was found"
        robot.notes += (f"no home is given: {np.round(robot.home, 2).tolist()} was searched for{aim}",)


def _checked(robot: Assembly, home: npt.ArrayLike) -> Array:
    q, names = np.asarray(home, dtype=np.float64), list(robot.model.names)[1:]
    if q.shape != (robot.model.nq,) or not np.isfinite(q).all():
        raise ConfigError(f"home must be {robot.model.nq} finite numbers, for {', '.join(names)}; got {q.tolist()}")
    limits = zip(names, q, robot.model.lowerPositionLimit, robot.model.upperPositionLimit, strict=True)
    for name, value, low, high in limits:
        if not low <= value <= high:
            raise ConfigError(f"home puts joint {name!r} at {value:g}, outside its limits {low:g} to {high:g}")
    return q
