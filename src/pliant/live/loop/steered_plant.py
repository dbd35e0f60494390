"""A simulated robot whose surroundings, imperfections and pushes change while it moves."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import Any

import numpy as np

from pliant.interfaces import Compensation, Plant
from pliant.live.link.messages import Pull
from pliant.live.loop.requests import Desk
from pliant.signals import Command, Measurement, Truth
from pliant.simulation import Imperfections, ImperfectPlant, MujocoPlant, Push, Scene, World
from pliant.simulation.imperfections.torque_loop import TorqueLoopConfig

_LET_GO = 0.5  # s of wall time after which a hand that says nothing has let go


@dataclass(slots=True)
class SteeredWorld:
    """The world, and the plant that moves it. Consumed by `step`."""

    plant: Plant[Any]
    physics: MujocoPlant | None
    """at the bottom of `plant`"""
    inner: Any
    scene: Scene | None
    flaws: Imperfections | None
    """the wishes that `plant` was built for"""
    last: Measurement


class SteeredPlant(Plant[SteeredWorld]):
    """Another plant, rebuilt round the same bodies whenever the desk asks for other surfaces or imperfections.

    Positions and velocities go on; commands and readings under way, filters and bristles start anew. Only a
    `MujocoPlant`, bare or in an `ImperfectPlant`, can be changed; any other plant runs as it is.

    Args:
        inner: the plant as the study built it.
        desk: read once a step.
        seed: of the draws of imperfections.
    """

    def __init__(self, inner: Plant[Any], desk: Desk, seed: int) -> None:
        self.inner, self._desk, self._seed = inner, desk, seed
        self.period = inner.period
        self.physics = physics_of(inner)
        """None if the plant cannot be changed"""
        self.built = inner.config if isinstance(inner, ImperfectPlant) else _perfect(inner)
        """its imperfections"""

    @property
    def compensates(self) -> Compensation:
        return self.inner.compensates

    def init(self) -> tuple[Measurement, SteeredWorld]:
        measurement, world = self.inner.init()
        return measurement, SteeredWorld(self.inner, self.physics, world, None, None, measurement)

    def step(self, command: Command, world: SteeredWorld) -> tuple[Measurement, SteeredWorld]:
        wishes = self._desk.wishes
        if wishes.scene is not world.scene or wishes.flaws is not world.flaws:
            self._rebuild(world)
        self._push(world)
        world.last, world.inner = world.plant.step(command, world.inner)
        return world.last, world

    def truth(self, world: SteeredWorld) -> Truth | None:
        return world.plant.truth(world.inner)

    def rehearse(self, scene: Scene | None, flaws: Imperfections | None) -> MujocoPlant | None:
        """Builds what a wish asks for and throws it away, except for its physics. Raises what is wrong with it."""
        if self.physics is None:
            return None
        physics = self.physics if scene is None else with_scene(self.physics, scene)
        if flaws is not None:
            ImperfectPlant(physics, flaws, seed=self._seed, period=self.period).init()
        return physics

    def _rebuild(self, world: SteeredWorld) -> None:
        wishes = self._desk.wishes
        if self.physics is None or world.physics is None:
            return
        old: World = world.inner.inner if isinstance(world.plant, ImperfectPlant) else world.inner
        physics = world.physics if wishes.scene is None else with_scene(self.physics, wishes.scene)
        measurement, inner = physics.resume(old)
        world.physics, world.scene, world.flaws = physics, wishes.scene, wishes.flaws
        flaws = wishes.flaws or self.built
        if not isinstance(self.inner, ImperfectPlant) and flaws == self.built:
            world.plant, world.inner = physics, inner
            return
        resumed = _Resumed(physics, measurement, inner)
        held = world.last.torque_sent
        world.plant = ImperfectPlant(resumed, flaws, seed=self._seed, period=self.period, holding_torque=held)
        _, world.inner = world.plant.init()

    def _push(self, world: SteeredWorld) -> None:
        if world.physics is None:
            return
        bottom: World = world.inner.inner if isinstance(world.plant, ImperfectPlant) else world.inner
        now = float(bottom.data.time)
        if self._desk.pushes:
            waiting, self._desk.pushes = self._desk.pushes, []
            bottom.pushes += [Push(frame, force, now, duration) for frame, force, duration in waiting]
        acting = [push for push in bottom.pushes if push.at(now) and not isinstance(push, _Hand)]
        pull, wishes = self._desk.wishes.pull, self._desk.wishes
        if pull is not None and any(pull.force) and time.monotonic() - wishes.pulled_at < _LET_GO:
            acting.append(_hand(pull, now))
        if bottom.pushes or acting:
            bottom.pushes = acting
        built = [push for push in world.physics.pushes if push.at(now)]
        self._desk.acting = (*built, *acting)


class _Hand(Push):
    """A push that follows a hand: made anew every period."""


def _hand(pull: Pull, now: float) -> _Hand:
    return _Hand(pull.frame, pull.force, now, np.inf)


class _Resumed(Plant[World]):
    """A plant whose start is where another one stopped."""

    def __init__(self, inner: MujocoPlant, measurement: Measurement, world: World) -> None:
        self.inner, self.period, self.joints = inner, inner.period, inner.joints
        self._measurement, self._world = measurement, world

    def init(self) -> tuple[Measurement, World]:
        return self._measurement, self._world

    def step(self, command: Command, world: World) -> tuple[Measurement, World]:
        return self.inner.step(command, world)

    def truth(self, world: World) -> Truth:
        return self.inner.truth(world)


def physics_of(plant: Plant[Any]) -> MujocoPlant | None:
    """The simulated robot in a plant that can be changed while it runs."""
    core = plant.inner if isinstance(plant, ImperfectPlant) else plant
    return core if isinstance(core, MujocoPlant) else None


def with_scene(plant: MujocoPlant, scene: Scene) -> MujocoPlant:
    """The same robot in another scene. Raises ConfigError if a surface does not fit the physics step."""
    _, world = plant.init()
    return MujocoPlant(
        plant.robot,
        scene,
        period=plant.period,
        physics_step=float(plant.model.opt.timestep),
        start=plant.start,
        joints=plant.joints,
        stops=plant.stops,
        sensors=plant.sensors,
        pushes=plant.pushes,
        links=plant.links,
        observe=list(plant.truth(world).positions),
        speed_stop=plant.speed_stop,
    )


def _perfect(plant: Plant[Any]) -> Imperfections:
    damping = 0.0
    core = physics_of(plant)
    if core is not None and np.ndim(core.joints.damping) == 0:
        damping = float(core.joints.damping)  # type: ignore[arg-type]  # a scalar, see above
    return Imperfections(joint_damping=damping, torque_loop=TorqueLoopConfig(period=min(0.1, plant.period)))
