"""The simulated plant: any robot of `Robot` in any `Scene`, torque in, sensors out, in MuJoCo."""

from __future__ import annotations

from collections.abc import Sequence

import mujoco
import numpy as np
import numpy.typing as npt

from pliant.errors import RunFailedError
from pliant.interfaces import Compensation, Plant
from pliant.robot import Robot
from pliant.signals import Command, Measurement, Truth
from pliant.simulation.compiled_world import WorldParts
from pliant.simulation.contact.explicit import ExplicitContacts, explicit_contacts
from pliant.simulation.contact.mujoco_forces import contact_wrenches
from pliant.simulation.contact.pairs import can_move, pairs_of
from pliant.simulation.disturbances import Push
from pliant.simulation.equilibrium import holding_torque
from pliant.simulation.force_sensor import ForceSensor, sensor_readings
from pliant.simulation.joint_effects import JointEffects
from pliant.simulation.joint_stops import JointStops, limits_of
from pliant.simulation.link_capsule import LinkCapsule
from pliant.simulation.scene import Scene
from pliant.simulation.stepping import shares, substeps
from pliant.simulation.world import World
from pliant.spatial import Array, clamp

SPEED_STOP = 2.0
"""multiple of the joints' speed limits at which a real arm stops"""


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
        stops: how hard the joints' mechanical limits are.
        sensors: force/torque sensors.
        pushes: disturbances.
        links: parts of the robot that touch things along their length, beside the frames with a contact radius.
        observe: more frames whose true pose is to be known; those that touch, sense or are pushed are in any case.
        speed_stop: multiple of the joints' speed limits at which a run stops as failed, as a real arm stops; None:
            it does not.

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
        stops: JointStops | None = None,
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
        physics_step = physics_step if physics_step is not None else 2e-5 if explicit else 5e-4
        self.substeps = substeps(period, physics_step)
        self.joints, self.stops = joints or JointEffects(), stops or JointStops()
        self.sensors = tuple(sensors)
        self.pushes = tuple(pushes)
        self.links = tuple(links)
        self.speed_stop = speed_stop
        self._limit = robot.torque_limit
        self._fastest = np.full(robot.n, np.inf) if speed_stop is None else speed_stop * robot.velocity_limit
        self.start = robot.vector(robot.home if start is None else start, "start")
        frames = [*observe, *(s.frame for s in sensors), *(p.frame for p in pushes), *robot.contact_radius]
        frames += [link.start for link in self.links]
        for frame in [*frames, *(link.end for link in self.links)]:
            robot.frame_id(frame)
        parts = WorldParts(robot, self.scene, self.joints, self.stops, self.links)
        self._parts = parts.touching_geoms
        pairs = pairs_of(self.scene, self._parts)
        self.model = parts.compile(physics_step, pairs)
        self.explicit = (
            explicit_contacts(self.model, self.start, pairs, self.scene.hollow, self.scene.meshes) if explicit else None
        )
        self._sites = {name: self.model.site(name).id for name in dict.fromkeys(frames)}
        things = [thing.name for thing in self.scene.things if can_move(thing)]
        self._movable = {name: self.model.body(name).id for name in things}
        self._contact_frames = {self.model.geom(geom).id: frame for geom, frame in self._parts.items()}
        self._lower, self._upper = limits_of(self.model, robot)
        self._felt = {s: [f for f in self._parts.values() if robot.carries(s.frame, f)] for s in self.sensors}

    # ------------------------------------------------------------------ Plant

    @property
    def compensates(self) -> Compensation:
        return self.joints.compensation

    def init(self) -> tuple[Measurement, World]:
        """The first measurement: at rest, held by the torque that keeps the robot in equilibrium (as far as the torque
        limits reach); it is what the measurement says was sent."""
        data = mujoco.MjData(self.model)
        data.qpos[: self.robot.n] = self.start
        world = World(data, 0, self._no_wrenches(), frozenset(), np.zeros(self.robot.n))
        self._refresh(world)
        world.torque = holding_torque(self.model, data, self.robot.n, self.robot.torque_limit)
        return self._started(world)

    def resume(self, world: World) -> tuple[Measurement, World]:
        """Goes on where a plant of the same robot and the same things stopped, for example one with another table."""
        data = mujoco.MjData(self.model)
        data.qpos[:], data.qvel[:], data.time = world.data.qpos, world.data.qvel, world.data.time
        again = World(data, world.ticks, self._no_wrenches(), frozenset(), world.torque, pushes=world.pushes)
        return self._started(again)

    def _started(self, world: World) -> tuple[Measurement, World]:
        self._refresh(world)
        if self.explicit is None:
            self._read_contacts(world)
        mujoco.mj_step1(self.model, world.data)
        return self._measure(world), world

    def _refresh(self, world: World) -> None:
        """Forces and accelerations under the held torque, without letting time pass."""
        data = world.data
        mujoco.mj_step1(self.model, data)
        if self.explicit is not None:
            world.contacts = self.explicit.init(data)
            self._read_explicit(world, self.explicit)
        self._apply(world)
        mujoco.mj_forward(self.model, data)

    def step(self, command: Command, world: World) -> tuple[Measurement, World]:
        world.torque = clamp(command.torque, -self._limit, self._limit)
        if self.explicit is None:
            self._step_mujoco(world)
        else:
            self._step_explicit(world, self.explicit)
        world.ticks += 1
        self._check_speed(world)
        return self._measure(world), world

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
            limit_excess=np.maximum(0.0, np.maximum(self._lower - data.qpos[:n], data.qpos[:n] - self._upper)),
            objects={name: np.concatenate([data.xpos[body], data.xquat[body]]) for name, body in self._movable.items()},
        )

    # ------------------------------------------------------------------ inside

    def _check_speed(self, world: World) -> None:
        speed = np.abs(world.data.qvel[: self.robot.n])
        if (speed <= self._fastest).all():
            return
        if not np.isfinite(speed).all():
            raise RunFailedError("the simulation diverged: a joint's speed is not a number; use a smaller physics step")
        joint = int(np.argmax(speed / self._fastest))
        raise RunFailedError(
            f"joint {self.robot.joint_names[joint]} ran at {speed[joint]:.1f} rad/s; the robot stops at"
            f" {self.speed_stop:g} times its speed limit"
        )

    def _step_mujoco(self, world: World) -> None:
        for last in range(self.substeps - 1, -1, -1):
            self._apply(world)
            mujoco.mj_step2(self.model, world.data)
            if last == 0:
                self._read_contacts(world)
            mujoco.mj_step1(self.model, world.data)

    def _step_explicit(self, world: World, contacts: ExplicitContacts) -> None:
        assert world.contacts is not None
        for steps in shares(self.substeps, 4 if self._follows_state(world) else 1):
            self._apply(world)
            contacts.advance(world.contacts, steps)
            mujoco.mj_step1(self.model, world.data)
        contacts.refresh(world.contacts)
        self._read_explicit(world, contacts)

    def _follows_state(self, world: World) -> bool:
        """Whether something besides the held torque changes within a period."""
        return bool(self.pushes or world.pushes) or self.joints.compensation == "gravity+coriolis"

    def _read_contacts(self, world: World) -> None:
        world.wrenches, world.touching = contact_wrenches(self.model, world.data, self._contact_frames, self._sites)

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
        return {frame: np.zeros(6) for frame in self._parts.values()}

    def _apply(self, world: World) -> None:
        n, data = self.robot.n, world.data
        data.qfrc_applied[:] = 0.0
        data.qfrc_applied[:n] = world.torque
        if self.joints.compensation == "gravity+coriolis":
            data.qfrc_applied[:n] += data.qfrc_bias[:n]
        for push in (*self.pushes, *world.pushes):
            if push.at(data.time):
                site = self.model.site(push.frame).id
                body = int(self.model.site_bodyid[site])
                force = np.array(push.force)
                mujoco.mj_applyFT(self.model, data, force, np.zeros(3), data.site_xpos[site], body, data.qfrc_applied)

    def _measure(self, world: World) -> Measurement:
        n, data = self.robot.n, world.data
        return Measurement(
            time=world.ticks * self.period,
            q=data.qpos[:n].copy(),
            v=data.qvel[:n].copy(),
            torque=world.torque.copy(),
            torque_sent=world.torque,
            wrenches=sensor_readings(self.model, data, self.sensors, self._sites, self._felt, world.wrenches),
        )
