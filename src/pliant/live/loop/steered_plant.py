"""A simulated robot whose surroundings, imperfections and pushes change while it moves."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import Any

import numpy as np

from pliant.interfaces import Compensation, Plant
from pliant.live.link.messages import Pull
from pliant.live.loop.requests import SharedState
from pliant.signals import Command, Measurement, Truth
from pliant.simulation import Imperfections, ImperfectPlant, MujocoPlant, Push, Scene, World
from pliant.simulation.imperfections.torque_loop import TorqueLoopConfig

_LET_GO = 0.5  # s of wall time without a new message after which a dragged force ends


@dataclass(slots=True)
class SteeredWorld:
    """The world, and the plant that moves it. Consumed by `step`."""

    plant: Plant[Any]
    physics: MujocoPlant | None
    """the innermost plant of `plant`"""
    inner: Any
    scene: Scene | None
    imperfections: Imperfections | None
    """the requests that `plant` was built for"""
    last: Measurement


class SteeredPlant(Plant[SteeredWorld]):
    """A plant that is rebuilt around the same bodies when a request changes surfaces or imperfections.

    Positions and velocities continue; delayed commands and readings, filters and friction bristles start again. Only a
    `MujocoPlant`, bare or in an `ImperfectPlant`, can be changed; any other plant runs as it is.

    Args:
        inner: the plant as the study built it.
        shared: the requests, read once a step.
        seed: of the draws of imperfections.
    """

    def __init__(self, inner: Plant[Any], shared: SharedState, seed: int) -> None:
        self.inner, self._shared, self._seed = inner, shared, seed
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
        requests = self._shared.requests
        if requests.scene is not world.scene or requests.imperfections is not world.imperfections:
            self._rebuild(world)
        self._push(world)
        world.last, world.inner = world.plant.step(command, world.inner)
        return world.last, world

    def truth(self, world: SteeredWorld) -> Truth | None:
        return world.plant.truth(world.inner)

    def rehearse(self, scene: Scene | None, imperfections: Imperfections | None) -> MujocoPlant | None:
        """Builds the requested plant as a test, keeps only its physics. Raises the error if it cannot be built."""
        if self.physics is None:
            return None
        physics = self.physics if scene is None else with_scene(self.physics, scene)
        if imperfections is not None:
            ImperfectPlant(physics, imperfections, seed=self._seed, period=self.period).init()
        return physics

    def _rebuild(self, world: SteeredWorld) -> None:
        requests = self._shared.requests
        if self.physics is None or world.physics is None:
            return
        old: World = world.inner.inner if isinstance(world.plant, ImperfectPlant) else world.inner
        physics = world.physics if requests.scene is None else with_scene(self.physics, requests.scene)
        measurement, inner = physics.resume(old)
        world.physics, world.scene, world.imperfections = physics, requests.scene, requests.imperfections
        imperfections = requests.imperfections or self.built
        if not isinstance(self.inner, ImperfectPlant) and imperfections == self.built:
            world.plant, world.inner = physics, inner
            return
        resumed = _Resumed(physics, measurement, inner)
        held = world.last.torque_sent
        world.plant = ImperfectPlant(resumed, imperfections, seed=self._seed, period=self.period, holding_torque=held)
        _, world.inner = world.plant.init()

    def _push(self, world: SteeredWorld) -> None:
        if world.physics is None:
            return
        bottom: World = world.inner.inner if isinstance(world.plant, ImperfectPlant) else world.inner
        now = float(bottom.data.time)
        if self._shared.pushes:
            waiting, self._shared.pushes = self._shared.pushes, []
            bottom.pushes += [Push(frame, force, now, duration) for frame, force, duration in waiting]
        acting = [push for push in bottom.pushes if push.at(now) and not isinstance(push, _Hand)]
        pull, requests = self._shared.requests.pull, self._shared.requests
        if pull is not None and any(pull.force) and time.monotonic() - requests.pulled_at < _LET_GO:
            acting.append(_hand(pull, now))
        if bottom.pushes or acting:
            bottom.pushes = acting
        built = [push for push in world.physics.pushes if push.at(now)]
        self._shared.acting = (*built, *acting)


class _Hand(Push):
    """A push that a user drags: made again in each period."""


def _hand(pull: Pull, now: float) -> _Hand:
    return _Hand(pull.frame, pull.force, now, np.inf)


class _Resumed(Plant[World]):
    """A plant that starts in the state in which another one stopped."""

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
