"""The simulated plant: any robot of `Robot` in any `Scene`, torque in, sensors out, in MuJoCo."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import mujoco
import numpy as np
import numpy.typing as npt

from pliant.errors import ConfigError, RunFailedError
from pliant.interfaces import Compensation, Plant
from pliant.mujoco_model import spec_from_robot
from pliant.robot import Robot
from pliant.signals import Command, Measurement, Truth
from pliant.simulation.contact.explicit import ContactState, ExplicitContacts, explicit_contacts
from pliant.simulation.contact.pairs import PairOfGeoms, pairs_of
from pliant.simulation.contact.recipe import add_pair, apply_surface
from pliant.simulation.disturbances import Push
from pliant.simulation.force_sensor import ForceSensor
from pliant.simulation.joint_effects import JointEffects
from pliant.simulation.link_capsule import LinkCapsule
from pliant.simulation.scene import Plane, Scene
from pliant.spatial import Array, cross


@dataclass(slots=True)
class World:
    """State of the simulated world. Consumed by `step`."""

    data: mujoco.MjData
    ticks: int
    """control periods since the start"""
    wrenches: dict[str, Array]
    """frame → (6,) contact wrench of the last physics step, world axes"""
    touching: frozenset[str]
    """frames and robot parts that touched something in the last physics step"""
    contacts: ContactState | None = None
    """of the explicit contact law"""
    pushes: list[Push] = field(default_factory=list[Push])
    """more disturbances than the plant was built with; may be changed between two steps"""


class MujocoPlant(Plant[World]):
    """A simulated robot whose sensors and actuators are perfect.

    The wrench read at the end of a period is the one that acted during its last physics step.

    Args:
        robot: the robot; frames with a contact radius can touch the things in the scene.
        scene: what it can meet.
        period: control period in s, a whole multiple of `physics_step`. Torques are held constant over it.
        physics_step: s; None: 0.5 ms, or 20 µs where the scene's contacts are explicit forces.
        start: (n,) configuration at the start, rad; None: the robot's home.
        joints: friction, damping and compensation of the joints.
        sensors: force/torque sensors.
        pushes: disturbances.
        links: parts of the robot that touch things along their length, beside the frames with a contact radius.
        observe: more frames whose true pose is to be known; those that touch, sense or are pushed are in any case.
        speed_stop: multiple of the joints' speed limits at which a run stops as failed, as a real arm stops; None:
            never.

    Raises:
        ConfigError: the period is not a multiple of the physics step, or the step is too long for a contact.
        RobotError: a frame that the robot does not have, or a robot without masses.
        ShapeError: `start` does not fit the robot.
    """

    def __init__(
        self,
        robot: Robot,
        scene: Scene | None = None,
        *,
        period: float = 1e-3,
        physics_step: float | None = None,
        start: npt.ArrayLike | None = None,
        joints: JointEffects | None = None,
        sensors: Sequence[ForceSensor] = (),
        pushes: Sequence[Push] = (),
        links: Sequence[LinkCapsule] = (),
        observe: Sequence[str] = (),
        speed_stop: float | None = None,
    ) -> None:
        robot.require_masses()
        self.robot = robot
        self.scene = scene or Scene()
        self.period = period
        explicit = self.scene.contact == "explicit"
        if physics_step is None:
            physics_step = 2e-5 if explicit else 5e-4
        self.substeps = _substeps(period, physics_step)
        self.joints = joints or JointEffects()
        self.sensors = tuple(sensors)
        self.pushes = tuple(pushes)
        self.links = tuple(links)
        self.speed_stop = speed_stop
        self._fastest = np.full(robot.n, np.inf) if speed_stop is None else speed_stop * robot.velocity_limit
        self.start = robot.vector(robot.home if start is None else start, "start")
        frames = [*observe, *(s.frame for s in sensors), *(p.frame for p in pushes), *robot.contact_radius]
        frames += [link.start for link in self.links]
        for frame in [*frames, *(link.end for link in self.links)]:
            robot.frame_id(frame)
        self._parts = {_touch(frame): frame for frame in robot.contact_radius}
        self._parts |= {_along(link.start): link.start for link in self.links}
        pairs = pairs_of(self.scene, self._parts)
        self.model = self._compile(physics_step, pairs)
        self.explicit = explicit_contacts(self.model, self.start, pairs) if explicit else None
        self._sites = {name: self.model.site(name).id for name in dict.fromkeys(frames)}
        self._movable = {
            thing.name: self.model.body(thing.name).id
            for thing in self.scene.things
            if not isinstance(thing, Plane) and thing.mass > 0.0
        }
        self._contact_frames = {self.model.geom(geom).id: frame for geom, frame in self._parts.items()}
        self._felt = {s: [f for f in self._parts.values() if robot.carries(s.frame, f)] for s in self.sensors}

    # ------------------------------------------------------------------ Plant

    @property
    def compensates(self) -> Compensation:
        return self.joints.compensation

    def init(self) -> tuple[Measurement, World]:
        data = mujoco.MjData(self.model)
        data.qpos[: self.robot.n] = self.start
        return self._started(World(data, 0, self._no_wrenches(), frozenset()))

    def resume(self, world: World) -> tuple[Measurement, World]:
        """Goes on where a plant of the same robot and the same things stopped, for example one with another table."""
        data = mujoco.MjData(self.model)
        data.qpos[:], data.qvel[:], data.time = world.data.qpos, world.data.qvel, world.data.time
        return self._started(World(data, world.ticks, self._no_wrenches(), frozenset(), pushes=world.pushes))

    def _started(self, world: World) -> tuple[Measurement, World]:
        data = world.data
        mujoco.mj_step1(self.model, data)
        self._apply(world, np.zeros(self.robot.n))  # what the robot compensates by itself, before the first command
        mujoco.mj_forward(self.model, data)
        if self.explicit is None:
            self._read_contacts(world)
        else:
            world.contacts = self.explicit.init(data)
            self._read_explicit(world, self.explicit)
        mujoco.mj_step1(self.model, data)
        return self._measure(world, np.zeros(self.robot.n)), world

    def step(self, command: Command, world: World) -> tuple[Measurement, World]:
        limit = self.robot.torque_limit
        torque = np.clip(command.torque, -limit, limit)
        if self.explicit is None:
            self._step_mujoco(world, torque)
        else:
            self._step_explicit(world, torque, self.explicit)
        world.ticks += 1
        self._check_speed(world)
        return self._measure(world, torque), world

    def truth(self, world: World) -> Truth:
        n, data = self.robot.n, world.data
        return Truth(
            time=world.ticks * self.period,
            q=data.qpos[:n].copy(),
            v=data.qvel[:n].copy(),
            torque=data.qfrc_applied[:n].copy(),
            positions={name: data.site_xpos[site].copy() for name, site in self._sites.items()},
            rotations={name: data.site_xmat[site].reshape(3, 3).copy() for name, site in self._sites.items()},
            wrenches=dict(world.wrenches),
            objects={name: np.concatenate([data.xpos[body], data.xquat[body]]) for name, body in self._movable.items()},
        )

    # ------------------------------------------------------------------ inside

    def _check_speed(self, world: World) -> None:
        speed = np.abs(world.data.qvel[: self.robot.n])
        if (speed <= self._fastest).all():
            return
        joint = int(np.argmax(speed / self._fastest))
        raise RunFailedError(
            f"joint {self.robot.joint_names[joint]} ran at {speed[joint]:.1f} rad/s; the robot stops at"
            f" {self.speed_stop:g} times its speed limit"
        )

    def _step_mujoco(self, world: World, torque: Array) -> None:
        for last in range(self.substeps - 1, -1, -1):
            self._apply(world, torque)
            mujoco.mj_step2(self.model, world.data)
            if last == 0:
                self._read_contacts(world)
            mujoco.mj_step1(self.model, world.data)

    def _step_explicit(self, world: World, torque: Array, contacts: ExplicitContacts) -> None:
        assert world.contacts is not None
        for steps in _shares(self.substeps, 4 if self._follows_state(world) else 1):
            self._apply(world, torque)
            contacts.advance(world.contacts, steps)
            mujoco.mj_step1(self.model, world.data)
        contacts.refresh(world.contacts)
        self._read_explicit(world, contacts)

    def _follows_state(self, world: World) -> bool:
        """Whether something besides the held torque changes within a period."""
        return bool(self.pushes or world.pushes) or self.joints.compensation == "gravity+coriolis"

    def _read_explicit(self, world: World, contacts: ExplicitContacts) -> None:
        assert world.contacts is not None
        world.wrenches = self._no_wrenches()
        touching: set[str] = set()
        for index, pair in enumerate(contacts.pairs):
            frame = self._parts.get(pair.geom_a)
            if frame is not None and contacts.touching(world.contacts, index):
                about = world.data.site_xpos[self._sites[frame]]
                world.wrenches[frame] += contacts.wrench(world.contacts, index, about)
                touching.add(frame)
        world.touching = frozenset(touching)

    def _no_wrenches(self) -> dict[str, Array]:
        return {frame: np.zeros(6) for frame in self._contact_frames.values()}

    def _compile(self, physics_step: float, pairs: Sequence[PairOfGeoms]) -> mujoco.MjModel:
        spec = spec_from_robot(self.robot)
        spec.option.timestep = physics_step
        spec.option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
        spec.option.disableflags |= mujoco.mjtDisableBit.mjDSBL_REFSAFE | mujoco.mjtDisableBit.mjDSBL_AUTORESET
        self._add_joint_effects(spec)
        for frame, radius in self.robot.contact_radius.items():
            site = spec.site(frame)
            geom = site.parent.add_geom(
                name=_touch(frame), type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[radius, 0, 0], pos=site.pos
            )
            geom.contype, geom.conaffinity, geom.mass, geom.rgba = 0, 0, 0.0, [0.20, 0.22, 0.25, 1.0]
        for link in self.links:
            link.add_to(spec, _along(link.start))
        for thing in self.scene.things:
            geom = thing.add_to(spec)
            geom.contype, geom.conaffinity = 0, 0
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
        return model

    def _add_joint_effects(self, spec: mujoco.MjSpec) -> None:
        friction = np.broadcast_to(np.asarray(self.joints.friction, dtype=np.float64), (self.robot.n,))
        damping = np.broadcast_to(np.asarray(self.joints.damping, dtype=np.float64), (self.robot.n,))
        for index, name in enumerate(self.robot.joint_names):
            joint = spec.joint(name)
            joint.frictionloss = friction[index]
            # MuJoCo's friction creeps below its limit; this viscosity is the largest that the step allows
            joint.solref_friction = [0.0, -1.0 / spec.option.timestep]
            joint.solimp_friction = [0.99, 0.99, 1e-3, 0.5, 2.0]
            joint.damping = [damping[index], 0.0, 0.0]
            if self.joints.compensation == "gravity":
                spec.body(name).gravcomp = 1.0

    def _apply(self, world: World, torque: Array) -> None:
        n, data = self.robot.n, world.data
        data.qfrc_applied[:] = 0.0
        data.qfrc_applied[:n] = torque
        if self.joints.compensation == "gravity+coriolis":
            data.qfrc_applied[:n] += data.qfrc_bias[:n]
        for push in (*self.pushes, *world.pushes):
            if push.at(data.time):
                site = self.model.site(push.frame).id
                body = int(self.model.site_bodyid[site])
                force = np.array(push.force)
                mujoco.mj_applyFT(self.model, data, force, np.zeros(3), data.site_xpos[site], body, data.qfrc_applied)

    def _read_contacts(self, world: World) -> None:
        """Sums the contact forces on every contact frame."""
        data = world.data
        world.wrenches = self._no_wrenches()
        touching: set[str] = set()
        local = np.zeros(6)
        for index in range(data.ncon):
            contact = data.contact[index]
            for geom, sign in ((int(contact.geom[0]), -1.0), (int(contact.geom[1]), 1.0)):
                frame = self._contact_frames.get(geom)
                if frame is None:
                    continue
                mujoco.mj_contactForce(self.model, data, index, local)
                force = sign * (contact.frame.reshape(3, 3).T @ local[:3])
                lever = contact.pos - data.site_xpos[self._sites[frame]]
                world.wrenches[frame] += np.concatenate([force, cross(lever, force)])
                touching.add(frame)
        world.touching = frozenset(touching)

    def _measure(self, world: World, torque: Array) -> Measurement:
        n, data = self.robot.n, world.data
        return Measurement(
            time=world.ticks * self.period,
            q=data.qpos[:n].copy(),
            v=data.qvel[:n].copy(),
            torque=torque.copy(),
            torque_sent=torque,
            wrenches=self._sensor_readings(world),
        )

    def _sensor_readings(self, world: World) -> Mapping[str, Array]:
        data = world.data
        readings: dict[str, Array] = {}
        for sensor in self.sensors:
            site = self._sites[sensor.frame]
            R_world_sensor = data.site_xmat[site].reshape(3, 3)
            force, moment = np.zeros(3), np.zeros(3)
            for frame in self._felt[sensor]:
                wrench, lever = world.wrenches[frame], data.site_xpos[self._sites[frame]] - data.site_xpos[site]
                force += wrench[:3]
                moment += wrench[3:] + cross(lever, wrench[:3])
            reading = np.concatenate([R_world_sensor.T @ force, R_world_sensor.T @ moment])
            if sensor.mass > 0.0:
                reading += self._carried(sensor, site, data)
            readings[sensor.frame] = reading
        return readings

    def _carried(self, sensor: ForceSensor, site: int, data: mujoco.MjData) -> Array:
        """Weight and inertial force of the mass behind a sensor, at its frame and in its axes, (6,)."""
        mujoco.mj_rnePostConstraint(self.model, data)
        motion = np.zeros(6)  # angular first; linear acceleration minus gravity
        mujoco.mj_objectAcceleration(self.model, data, mujoco.mjtObj.mjOBJ_SITE, site, motion, 1)
        spin = np.zeros(6)
        mujoco.mj_objectVelocity(self.model, data, mujoco.mjtObj.mjOBJ_SITE, site, spin, 1)
        center = np.array(sensor.center)
        acceleration = motion[3:] + cross(motion[:3], center) + cross(spin[:3], cross(spin[:3], center))
        force = -sensor.mass * acceleration
        return np.concatenate([force, cross(center, force)])


def _touch(frame: str) -> str:
    """Name of the geom with which a frame touches things."""
    return f"touch:{frame}"


def _along(frame: str) -> str:
    """Name of the geom with which a link that starts at a frame touches things."""
    return f"along:{frame}"


def _substeps(period: float, physics_step: float) -> int:
    if not (physics_step > 0.0 and period > 0.0):
        raise ConfigError(f"period and physics step must be above zero, got {period} s and {physics_step} s")
    ratio = period / physics_step
    if abs(ratio - round(ratio)) > 1e-6 or round(ratio) < 1:
        raise ConfigError(
            f"the control period must be a whole multiple of the physics step, got {period:g} s and {physics_step:g} s"
        )
    return round(ratio)


def _shares(total: int, parts: int) -> list[int]:
    """A whole number in about equal parts, none of them zero."""
    return [len(part) for part in np.array_split(np.arange(total), min(parts, total))]


def _add_light(spec: mujoco.MjSpec) -> None:
    spec.worldbody.add_light(pos=[1.0, -1.5, 3.0], dir=[-0.3, 0.45, -0.85], castshadow=False)
    spec.worldbody.add_light(pos=[-1.5, -1.0, 2.0], dir=[0.5, 0.3, -0.6], castshadow=False)
