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
from pliant.simulation.compiled_period import CompiledPeriod, compiled_period_of
from pliant.simulation.compiled_robot import CompiledRobot
from pliant.simulation.compiled_world import WorldParts
from pliant.simulation.contact.explicit import explicit_contacts
from pliant.simulation.contact.pairs import can_move, pairs_of
from pliant.simulation.disturbances import Push
from pliant.simulation.equilibrium import holding_torque
from pliant.simulation.force_sensor import ForceSensor, sensor_readings
from pliant.simulation.joint_effects import JointEffects
from pliant.simulation.joint_stops import JointStops, limits_of
from pliant.simulation.link_capsule import LinkCapsule
from pliant.simulation.mujoco_library import can_look_inside
from pliant.simulation.python_period import PythonPeriod
from pliant.simulation.scene import Scene
from pliant.simulation.stepping import substeps
from pliant.simulation.truth import TruthReader
from pliant.simulation.what_touches import WhatTouches
from pliant.simulation.world import World
from pliant.spatial import Array, clamp

SPEED_STOP = 2.0
"""multiple of the joints' speed limits at which a real arm would stop"""


class MujocoPlant(Plant[World]):
    """A simulated robot whose sensors and actuators are perfect.

    The wrench read at the end of a period is the one that acted during its last physics step.

    Args:
        robot: the robot; frames with a contact radius can touch the things in the scene.
        scene: the things around the robot.
        period: control period in s, a whole multiple of `physics_step`. Torques are held constant over it.
        physics_step: s; None: 0.5 ms, or 20 µs where the scene's contacts are explicit forces.
        start: (n,) configuration at the start, rad; None: the robot's home.
        joints: friction, damping and compensation of the joints.
        stops: stiffness and damping of the joints' mechanical limits.
        sensors: force/torque sensors.
        pushes: disturbances.
        links: parts of the robot with contact along their length, in addition to the frames with a contact radius.
        observe: further frames whose true pose is recorded; contact, sensor and pushed frames are included.
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
        frames = [*observe, *(s.frame for s in sensors), *(p.frame for p in pushes)]
        frames += [*robot.contact_radius, *robot.contact_bodies, *(link.start for link in self.links)]
        for frame in [*frames, *(link.end for link in self.links)]:
            robot.frame_id(frame)
        parts = WorldParts(robot, self.scene, self.joints, self.stops, self.links)
        self._build(parts, physics_step, list(dict.fromkeys(frames)))

    # ------------------------------------------------------------------ Plant

    @property
    def compensates(self) -> Compensation:
        return self.joints.compensation

    def init(self) -> tuple[Measurement, World]:
        """The first measurement: at rest, held by the torque that keeps the robot in equilibrium (as far as the torque
        limits reach); it is what the measurement says was sent."""
        data = mujoco.MjData(self.model)
        data.qpos[: self.robot.n] = self.start
        world = World(data, 0, self._loop.no_wrenches(), frozenset(), np.zeros(self.robot.n))
        self._loop.refresh(world)
        world.torque = holding_torque(self.model, data, self.robot.n, self.robot.torque_limit)
        return self._started(world)

    def resume(self, world: World) -> tuple[Measurement, World]:
        """Continues from the state of a plant with the same robot and the same things, for example one with another
        table."""
        data = mujoco.MjData(self.model)
        data.qpos[:], data.qvel[:], data.time = world.data.qpos, world.data.qvel, world.data.time
        again = World(data, world.ticks, self._loop.no_wrenches(), frozenset(), world.torque, pushes=world.pushes)
        return self._started(again)

    def _started(self, world: World) -> tuple[Measurement, World]:
        self._loop.refresh(world)
        if self.explicit is None:
            self._loop.read_contacts(world)
        mujoco.mj_step1(self.model, world.data)
        return self._measure(world), world

    def step(self, command: Command, world: World) -> tuple[Measurement, World]:
        if self.compiled is not None:
            out, touching = self.compiled.step(world, command.torque)
            time = self.passed(world, 1, out, touching)
            q, v, torque = self.compiled.signals(out)
            return Measurement(time, q, v, torque, torque, self.compiled.readings(out)), world
        world.torque = clamp(command.torque, -self._limit, self._limit)
        self._loop.step(world)
        world.ticks += 1
        self._check_speed(world)
        return self._measure(world), world

    def passed(self, world: World, periods: int, out: Array, touching: int) -> float:
        """Writes compiled periods into the world. Returns its time in s.

        Args:
            world: consumed.
            periods: how many there were.
            out: the outcome of the last of them.
            touching: what came back from it.

        Raises:
            RunFailedError: a joint was too fast.
        """
        world.ticks += periods
        if touching < 0:
            self._check_speed(world)
        assert self.compiled is not None
        self.compiled.keep(world, out, touching)
        return world.ticks * self.period

    def compiled_face(self, world: World) -> CompiledRobot | None:
        core, compiled = self._truth.core, compiled_period_of(self)
        if core is None or compiled is None:
            return None
        return CompiledRobot(compiled, self._truth, core, world, self.period, self.passed)

    def truth(self, world: World) -> Truth:
        return self._truth.truth(world, world.ticks * self.period)

    # ------------------------------------------------------------------ inside

    def _build(self, parts: WorldParts, physics_step: float, frames: Sequence[str]) -> None:
        """Model and loops. Args: parts; physics_step, s; frames whose places are told."""
        robot, scene = self.robot, self.scene
        pairs = pairs_of(scene, parts.touching_geoms)
        self.model = parts.compile(physics_step, pairs)
        self.explicit = (
            explicit_contacts(self.model, self.start, pairs, scene.hollow, scene.forms, parts.tools)
            if scene.contact == "explicit"
            else None
        )
        self._sites = {name: self.model.site(name).id for name in frames}
        things = [thing.name for thing in scene.things if can_move(thing)]
        movable = {name: self.model.body(name).id for name in things}
        self._truth = TruthReader(self.model, *limits_of(self.model, robot), self._sites, movable)
        felt = {s: [f for f in parts.touching_geoms.values() if robot.carries(s.frame, f)] for s in self.sensors}
        geoms = {self.model.geom(geom).id: frame for geom, frame in parts.touching_geoms.items()}
        self._touches = WhatTouches(geoms, self._sites, self.sensors, felt)
        self._loop = PythonPeriod(
            self.model,
            self._touches,
            parts.touching_geoms,
            self.explicit,
            robot.n,
            self.substeps,
            self.joints,
            self.pushes,
        )
        self.compiled = self._compile() if can_look_inside() else None
        """its compiled period; None where MuJoCo is not the one that pliant was compiled for"""

    def _compile(self) -> CompiledPeriod:
        return CompiledPeriod(
            self.model,
            self._touches,
            substeps=self.substeps,
            coriolis=self.joints.compensation == "gravity+coriolis",
            limit=self._limit,
            fastest=self._fastest,
            pushes=self.pushes,
            explicit=self.explicit,
        )

    def _check_speed(self, world: World) -> None:
        speed = np.abs(world.data.qvel[: self.robot.n])
        if (speed <= self._fastest).all():
            return
        if not np.isfinite(speed).all():
            raise RunFailedError("the simulation diverged: a joint's speed is not a number; use a smaller physics step")
        joint = int(np.argmax(speed / self._fastest))
        raise RunFailedError(
            f"joint {self.robot.joint_names[joint]} reached {speed[joint]:.1f} rad/s; the robot stops at"
            f" {self.speed_stop:g} times its speed limit"
        )

    def _measure(self, world: World) -> Measurement:
        n, data = self.robot.n, world.data
        return Measurement(
            time=world.ticks * self.period,
            q=data.qpos[:n].copy(),
            v=data.qvel[:n].copy(),
            torque=world.torque.copy(),
            torque_sent=world.torque,
            wrenches=sensor_readings(self.model, data, self.sensors, self._sites, self._touches.felt, world.wrenches),
        )
