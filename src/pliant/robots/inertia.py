"""Checks that masses and inertias of links are physically possible, before a simulation fails."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from pliant.errors import RobotError
from pliant.robots.description import is_revolute, lock_hint
from pliant.spatial import Array

TINY = 1e-6
"""kg, and kg m² about each axis: what a massless robot is given so that its kinematics can be used"""
_NOTHING = 1e-12
_LATE = 7e-3
"""s: typical period plus delays of a robot"""
_LATE_SHARE = 0.42
"""largest K T² / J of a critically damped loop"""
_ASKED = 25.0
"""N·m/rad; rotational stiffness for a tool of 0.2 m"""


def check_inertia(model: pin.Model, source: object) -> tuple[list[str], tuple[str, ...]]:
    """Finds joints without inertia, and inertias that are not physically possible. Gives a massless robot a tiny mass.

    Args:
        model: the robot; changed where nothing in it has mass.
        source: what to call it.

    Returns:
        What there is to say, and why the robot cannot be simulated (empty if it can).

    Raises:
        RobotError: a joint that moves nothing with mass, in a robot that has masses elsewhere.
    """
    masses = np.array([float(i.mass) for i in model.inertias])[1:]
    if not np.any(masses > 0.0):
        for index in range(1, model.njoints):
            model.inertias[index] = pin.Inertia(TINY, np.zeros(3), TINY * np.eye(3))
        note = f"no link has a mass: {TINY:g} kg is assumed for each, which serves kinematics only"
        return [note], (f"no link of {source} has a mass (<inertial>)",)
    notes, reasons = list[str](), list[str]()
    resisted = _resistance(model)
    for index in range(1, model.njoints):
        name = _carried(model, index)
        if resisted[model.joints[index].idx_v] < _NOTHING:
            raise RobotError(
                f"{source}: link {name!r}, moved by joint {model.names[index]!r}, has no mass and carries none; give it"
                f" an <inertial>, or lock the joint: {lock_hint(model.names[index])}"
            )
        if masses[index - 1] <= 0.0 and not _is_between(model, index):
            notes.append(f"link {name!r} has no mass of its own; what it carries gives its inertia")
        fault = _fault(np.linalg.eigvalsh(np.array(model.inertias[index].inertia)))
        if fault is not None:
            notes.append(f"link {name!r} has {fault}")
            reasons.append(f"link {name!r} has {fault}")
    return notes, tuple(reasons)


def small_inertia(model: pin.Model, home: Array) -> list[str]:
    """Notes about joints with so little inertia that the delay of the loop bounds the stiffness about them.

    A critically damped loop on an inertia J, with a total delay T, is at its limit of stability with K = 0.42 J / T²:
    there its crossover, 2.06 √(K/J), times T is its phase margin of 76°. J is what the joint feels with the others
    free.
    """
    inverse = np.linalg.inv(_mass_matrix(model, home))
    found: list[tuple[str, float]] = []
    for joint in range(1, model.njoints):
        inertia = 1.0 / float(inverse[model.joints[joint].idx_v, model.joints[joint].idx_v])
        if is_revolute(model, joint) and _LATE_SHARE * inertia / _LATE**2 < _ASKED:
            found.append((str(model.names[joint]), inertia))
    if not found:
        return []
    name, least = min(found, key=lambda one: one[1])
    told = ", ".join(one for one, _ in found)
    bound = _LATE_SHARE * least / _LATE**2
    return [
        f"little inertia about {told} ({least:.2g} kg m² at {name!r}): a loop that is {1e3 * _LATE:g} ms late holds at"
        f" most {bound:.2g} N·m/rad there; if the motors are missing in the file, --set rotor_inertia=assumed or a"
        " number in kg m² adds them"
    ]


def _mass_matrix(model: pin.Model, q: Array) -> Array:
    upper = np.triu(np.array(pin.crba(model, model.createData(), q)))
    return np.array(upper + np.triu(upper, 1).T)


def _resistance(model: pin.Model) -> Array:
    """Least diagonal of the mass matrix over a few configurations, (n,)."""
    data, rng = model.createData(), np.random.default_rng(0)
    rows = [np.diag(pin.crba(model, data, rng.uniform(-1.0, 1.0, model.nq))) for _ in range(4)]
    return np.max(rows, axis=0)


def _is_between(model: pin.Model, index: int) -> bool:
    """Whether a joint is one of several at one body, so that it has no link of its own."""
    follows = [j for j in range(1, model.njoints) if model.parents[j] == index]
    return len(follows) == 1 and float(np.linalg.norm(model.jointPlacements[follows[0]].translation)) < 1e-12


def _carried(model: pin.Model, index: int) -> str:
    """Name of the link that a joint moves."""
    bodies = [f.name for f in model.frames if f.type == pin.FrameType.BODY and f.parentJoint == index]
    return bodies[0] if bodies else str(model.names[index])


def _fault(moments: Array) -> str | None:
    """The fault of principal moments of inertia (3,), kg m², ascending."""
    small, middle, large = (float(m) for m in moments)
    if small < -1e-9:
        return f"the principal moment of inertia {small:.3g} kg m², which is negative"
    if small + middle < large * (1.0 - 1e-6) - 1e-12:
        return (
            f"the principal moments of inertia {small:.3g}, {middle:.3g} and {large:.3g} kg m²; no body has them, since"
            " two must add up to more than the third"
        )
    return None
