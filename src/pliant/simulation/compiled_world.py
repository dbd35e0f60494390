"""A robot in a scene as one MuJoCo model."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import mujoco
import numpy as np

from pliant.errors import ConfigError
from pliant.mujoco_model import spec_from_robot
from pliant.robot import Robot
from pliant.robots.tool import ToolBody
from pliant.simulation.contact.pairs import PairOfGeoms
from pliant.simulation.contact.recipe import add_pair, apply_surface
from pliant.simulation.joint_effects import JointEffects
from pliant.simulation.joint_stops import JointStops, apply_stops
from pliant.simulation.link_capsule import LinkCapsule
from pliant.simulation.scene import Scene


@dataclass(frozen=True)
class WorldParts:
    """The parts of a simulated world."""

    robot: Robot
    scene: Scene
    joints: JointEffects
    stops: JointStops
    links: tuple[LinkCapsule, ...]

    @property
    def touching_geoms(self) -> Mapping[str, str]:
        """Contact geom of the robot → the frame at which its contact is reported."""
        parts = {f"touch:{frame}": frame for frame in (*self.robot.contact_radius, *self.robot.contact_bodies)}
        return parts | {f"along:{link.start}": link.start for link in self.links}

    @property
    def tools(self) -> frozenset[str]:
        """The geoms with several contact points."""
        return frozenset(f"touch:{frame}" for frame in self.robot.contact_bodies)

    def compile(self, physics_step: float, pairs: Sequence[PairOfGeoms]) -> mujoco.MjModel:
        """The model; contacts of an explicit law are switched off in it.

        Args:
            physics_step: s.
            pairs: pairs of geoms in contact, with their contact properties.

        Raises:
            ConfigError: MuJoCo cannot build it, or the step is too long for a contact.
        """
        if self.tools and self.scene.contact == "mujoco":
            frame, body = next(iter(self.robot.contact_bodies.items()))
            raise ConfigError(
                f"tool {frame!r} is a {body.shape}, whose contact points share a stiffness, which MuJoCo's"
                " contacts do not support: set"
                " contact = 'explicit'"
            )
        spec = spec_from_robot(self.robot)
        spec.option.timestep = physics_step
        spec.option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
        spec.option.disableflags |= mujoco.mjtDisableBit.mjDSBL_REFSAFE | mujoco.mjtDisableBit.mjDSBL_AUTORESET
        self._add_joint_effects(spec)
        self._add_geoms(spec)
        if self.scene.contact == "explicit":
            spec.option.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
            pairs = []
        for a, b, _ in pairs:
            add_pair(spec, f"{a}|{b}", a, b)
        _add_light(spec)
        try:
            model = spec.compile()
        except ValueError as error:
            raise ConfigError(f"MuJoCo cannot build robot {self.robot.name!r} in this scene: {error}") from error
        for a, b, surface in pairs:
            apply_surface(model, f"{a}|{b}", surface)
        apply_stops(model, self.robot, self.stops)
        return model

    def _add_geoms(self, spec: mujoco.MjSpec) -> None:
        for frame, radius in self.robot.contact_radius.items():
            site = spec.site(frame)
            geom = site.parent.add_geom(
                name=f"touch:{frame}", type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[radius, 0, 0], pos=site.pos
            )
            geom.contype, geom.conaffinity, geom.mass, geom.rgba = 0, 0, 0.0, [0.20, 0.22, 0.25, 1.0]
        for frame, body in self.robot.contact_bodies.items():
            _add_body(spec, frame, body, seen=self.robot.visual is None)
        for link in self.links:
            link.add_to(spec, f"along:{link.start}")
        for thing in self.scene.things:
            geom = thing.add_to(spec)
            geom.contype, geom.conaffinity = 0, 0

    def _add_joint_effects(self, spec: mujoco.MjSpec) -> None:
        n = self.robot.n
        friction = np.broadcast_to(np.asarray(self.joints.friction, dtype=np.float64), (n,))
        damping = np.broadcast_to(np.asarray(self.joints.damping, dtype=np.float64), (n,))
        for index, name in enumerate(self.robot.joint_names):
            joint = spec.joint(name)
            joint.frictionloss = friction[index]
            # MuJoCo's friction creeps below its limit; this viscosity is the largest that the step allows
            joint.solref_friction = [0.0, -1.0 / spec.option.timestep]
            joint.solimp_friction = [0.99, 0.99, 1e-3, 0.5, 2.0]
            joint.damping = [damping[index], 0.0, 0.0]
            if self.joints.compensation == "gravity":
                spec.body(name).gravcomp = 1.0


def _add_body(spec: mujoco.MjSpec, frame: str, body: ToolBody, seen: bool) -> None:
    """The contact shape of a tool, behind its frame. Args: seen: whether it is drawn; the robot's visual shapes show it
    already."""
    site = spec.site(frame)
    R = np.zeros(9)
    mujoco.mju_quat2Mat(R, np.asarray(site.quat, dtype=np.float64))
    cylinder = body.shape == "cylinder"
    geom = site.parent.add_geom(
        name=f"touch:{frame}",
        type=mujoco.mjtGeom.mjGEOM_CYLINDER if cylinder else mujoco.mjtGeom.mjGEOM_BOX,
        size=[body.half[0], body.half[2], 0.0] if cylinder else list(body.half),
        pos=np.asarray(site.pos) - body.half[2] * R.reshape(3, 3)[:, 2],
        quat=site.quat,
    )
    geom.contype, geom.conaffinity, geom.mass = 0, 0, 0.0
    geom.rgba = [0.20, 0.22, 0.25, 1.0] if seen else [0, 0, 0, 0]


def _add_light(spec: mujoco.MjSpec) -> None:
    spec.worldbody.add_light(pos=[1.0, -1.5, 3.0], dir=[-0.3, 0.45, -0.85], castshadow=False)
    spec.worldbody.add_light(pos=[-1.5, -1.0, 2.0], dir=[0.5, 0.3, -0.6], castshadow=False)
