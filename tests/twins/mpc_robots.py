"""Chains for the tests of the MPC core: the same robot as a pinocchio model (the oracle) and as the kernel's chain."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from pliant import _mpc
from pliant.robot import Robot, Tool

Vector = np.ndarray


@dataclass(frozen=True)
class TestChain:
    """A pinocchio model with frames "tool" and "contact", its kernel chain, and a configuration to work at."""

    __test__ = False
    model: pin.Model
    chain: _mpc.Chain
    damping: Vector  # (n,) N·m·s/rad
    home: Vector  # (n,) rad


def _axis(joint: pin.JointModel) -> tuple[str, Vector]:
    """Type and axis of a joint, from the motion subspace at zero."""
    data = joint.createData()
    joint.calc(data, pin.neutral(_single(joint)))
    subspace = np.asarray(data.S).reshape(6)
    prismatic = np.linalg.norm(subspace[:3]) > 0.5
    return ("prismatic", subspace[:3]) if prismatic else ("revolute", subspace[3:])


def _single(joint: pin.JointModel) -> pin.Model:
    model = pin.Model()
    model.addJoint(0, joint, pin.SE3.Identity(), "joint")
    return model


def chain_of(model: pin.Model, damping: Vector, tool: str = "tool", contact: str = "contact") -> _mpc.Chain:
    """The kernel's chain of a serial pinocchio model."""
    n = model.nv
    kinds, axes = zip(*(_axis(model.joints[i + 1].shortname() and model.joints[i + 1]) for i in range(n)), strict=True)
    inertias = [model.inertias[i + 1] for i in range(n)]
    tool_placement = model.frames[model.getFrameId(tool)].placement
    contact_placement = model.frames[model.getFrameId(contact)].placement
    return _mpc.Chain(
        np.array([model.jointPlacements[i + 1].rotation for i in range(n)]),
        np.array([model.jointPlacements[i + 1].translation for i in range(n)]),
        list(kinds),
        np.array(axes),
        np.array([inertia.mass for inertia in inertias]),
        np.array([inertia.lever for inertia in inertias]),
        np.array([inertia.inertia for inertia in inertias]),
        rotor_inertia=model.armature.copy(),
        joint_damping=damping,
        gravity=model.gravity.linear.copy(),
        tool_rotation=tool_placement.rotation,
        tool_translation=tool_placement.translation,
        contact_rotation=contact_placement.rotation,
        contact_translation=contact_placement.translation,
    )


def add_frames(model: pin.Model, tool: pin.SE3, contact: pin.SE3) -> None:
    """Frames on the last link."""
    last = model.njoints - 1
    for name, placement in (("tool", tool), ("contact", contact)):
        if not model.existFrame(name):
            model.addFrame(pin.Frame(name, last, placement, pin.FrameType.OP_FRAME))


def random_chain(n: int, seed: int, prismatic: float = 0.3) -> TestChain:
    """n joints with random axes, fixed transforms, inertias, rotors and damping; tool and contact frames differ."""
    rng = np.random.default_rng(seed)
    model = pin.Model()
    for i in range(n):
        axis = rng.normal(size=3)
        axis /= np.linalg.norm(axis)
        slides = rng.random() < prismatic
        joint = pin.JointModelPrismaticUnaligned(axis) if slides else pin.JointModelRevoluteUnaligned(axis)
        placement = pin.SE3(pin.exp3(rng.normal(size=3)), 0.3 * rng.normal(size=3))
        index = model.addJoint(i, joint, placement, f"joint{i}")
        half = rng.normal(size=(3, 3))
        inertia = pin.Inertia(rng.uniform(0.5, 4.0), 0.1 * rng.normal(size=3), 0.02 * half @ half.T + 0.01 * np.eye(3))
        model.appendBodyToJoint(index, inertia, pin.SE3.Identity())
    model.armature[:] = rng.uniform(0.0, 0.1, n)
    add_frames(
        model,
        pin.SE3(pin.exp3(rng.normal(size=3)), 0.1 * rng.normal(size=3)),
        pin.SE3(pin.exp3(rng.normal(size=3)), 0.1 * rng.normal(size=3)),
    )
    damping = rng.uniform(0.0, 0.5, n)
    return TestChain(model, chain_of(model, damping), damping, rng.uniform(-1.0, 1.0, n))


def catalogue_chain(name: str) -> TestChain:
    """lwr4, iiwa14 with A7 locked and the polishing tool, or leg3."""
    robot = Robot.load(name)
    home = np.array(robot.home, dtype=float)
    if name == "iiwa14":
        robot = robot.with_locked({robot.joint_names[6]: 0.0}).with_tool(Tool())
        home = np.array([0.0, 1.0472, 0.0, -1.13446, 0.2, 0.7854])
    model = robot.model.copy()
    last = model.njoints - 1
    operational = [f for f in model.frames if f.parentJoint == last and f.name not in ("universe",)]
    end = operational[-1].placement
    add_frames(model, end, end)
    damping = np.zeros(model.nv)
    return TestChain(model, chain_of(model, damping), damping, home)
