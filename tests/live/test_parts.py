"""Parts of the page that need no browser: mailbox, fields, clock, surroundings."""

from __future__ import annotations

import logging
import time
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from pydantic import BaseModel

from pliant.environment import Environment, EstimatedSurface
from pliant.errors import ConfigError
from pliant.live.link.mailbox import Mailbox
from pliant.live.link.messages import Aim, Flow, PushNow, StepOnce
from pliant.live.loop.pace import Pace
from pliant.live.loop.requests import Requests, SharedState
from pliant.live.loop.steered_plant import SteeredPlant
from pliant.live.page.estimates_panel import environment_line, surface_line
from pliant.live.page.fields import group_of, nested
from pliant.live.page.form import parsed
from pliant.live.page.pushes import PushControls
from pliant.live.page.world_form import SceneForm
from pliant.live.server.protected import _quiet
from pliant.quantity import quantity
from pliant.robot import Robot
from pliant.signals import Command
from pliant.simulation import Imperfections, MujocoPlant, Scene, Surface, floor
from pliant.simulation.imperfections.actuation import ActuationConfig

# ---------------------------------------------------------------------- what is felt


def test_what_is_felt_is_a_line_with_units_and_uncertainty() -> None:
    felt = Environment(stiffness=19_876.0, damping=103.4, stiffness_std=312.0, damping_std=np.inf)
    assert environment_line("tool", felt) == "estimated at **tool**: stiffness 19900 ± 310 N/m, damping unknown"
    turned = EstimatedSurface(np.zeros(3), np.radians([3.0, 4.0, 0.0]), np.array([0.0, 0.0, 1.0]), np.radians(0.25))
    assert surface_line("tool", turned) == "estimated at **tool**: surface tilted by 5 ± 0.25 °"


# ---------------------------------------------------------------------- mailbox


def test_the_latest_value_wins_and_events_keep_their_order() -> None:
    box = Mailbox()
    for offset in range(1000):
        box.put(Aim((0.001 * offset, 0.0, 0.0)))
    for step in range(3):
        box.put(StepOnce(step + 1))
    assert box.waiting
    assert box.take() == [StepOnce(1), StepOnce(2), StepOnce(3), Aim((0.999, 0.0, 0.0))]
    assert not box.waiting
    assert box.take() == []


def test_a_reader_that_never_comes_costs_bounded_memory() -> None:
    box = Mailbox()
    for _ in range(10_000):
        box.put(PushNow("tool", (1.0, 0.0, 0.0), 0.1))
    assert len(box.take()) <= 256


# ---------------------------------------------------------------------- controls from types


class Inner(BaseModel):
    gain: float = quantity(2.0, "N/m", "K", shown=(0.0, 9.0), ge=0.0)
    mode: bool = False
    axes: tuple[float, float, float] = (1.0, 2.0, 3.0)
    limit: float | None = None


class Outer(BaseModel):
    inner: Inner = Inner()
    parts: dict[str, Inner | None] = {"a": Inner(), "b": None}
    name: str = "x"


def test_every_value_becomes_a_leaf_with_unit_range_and_help() -> None:
    leaves = {leaf.path: leaf for leaf in group_of(Outer()).leaves()}
    gain = leaves[("inner", "gain")]
    assert (gain.kind, gain.unit, gain.minimum, gain.maximum, gain.description) == ("number", "N/m", 0.0, 9.0, "K")
    assert leaves[("parts", "a", "gain")].value == 2.0
    assert ("parts", "b", "gain") not in leaves
    assert leaves[("inner", "mode")].kind == "switch"
    assert leaves[("inner", "axes")].kind == "vector"
    limit = leaves[("inner", "limit")]
    assert (limit.kind, limit.optional) == ("text", True)
    assert parsed(limit, "none") is None
    assert parsed(limit, "2.5") == 2.5
    assert nested(("a", "b"), 1) == {"a": {"b": 1}}


# ---------------------------------------------------------------------- the clock


def test_pause_holds_and_steps_count() -> None:
    pace = Pace(1e-3, lambda: None, lambda seconds: time.sleep(0.001))
    pace.flow = Flow(playing=False)
    pace.steps = 3
    seen: list[object] = []

    def stop_when_idle() -> None:
        pace.stopped = len(seen) == 3 and pace.steps == 0

    pace._attend = stop_when_idle  # the only way to look in from outside
    for item in pace(range(10)):
        seen.append(item)
    assert seen == [0, 1, 2]


def test_slow_motion_takes_longer() -> None:
    """Twenty periods at a fifth of the speed take at least five times as long as they last."""
    pace = Pace(1e-3, lambda: None, time.sleep)
    pace.flow = Flow(speed=0.2)
    start = time.perf_counter()
    assert len(list(pace(range(20)))) == 20
    assert time.perf_counter() - start >= 0.9 * 19 * 1e-3 / 0.2


# ---------------------------------------------------------------------- surroundings


def leg(contact: str = "mujoco") -> MujocoPlant:
    robot = Robot.load("leg3")
    law: dict[str, object] = {"contact": contact}
    scene = Scene((floor(-0.6, Surface(1e4, 1e2, 0.5)),), **law)  # type: ignore[arg-type]
    return MujocoPlant(robot, scene, observe=["foot"] if "foot" in robot.frame_names else [])


def still(plant: MujocoPlant) -> Command:
    n = plant.robot.n
    return Command(0.0, np.zeros(n), np.zeros(n))


@pytest.mark.parametrize("contact", ["mujoco", "explicit"])
def test_another_floor_does_not_move_the_robot(contact: str) -> None:
    """State goes on across a change of the scene; what follows differs, since the floor leans now."""
    plants = [SteeredPlant(leg(contact), SharedState(), 0) for _ in range(2)]
    worlds = [plant.init()[1] for plant in plants]
    for _ in range(50):
        for plant, world in zip(plants, worlds, strict=True):
            plant.step(still(plant.physics), world)  # type: ignore[arg-type]
    physics = plants[1].physics
    assert physics is not None
    form = SceneForm(physics.scene)
    form.changed(("floor", "tilt"), 0.2)
    plants[1]._shared.requests = Requests(scene=form.scene)
    time_before = worlds[1].last.time
    measurements = [plant.step(still(physics), world)[0] for plant, world in zip(plants, worlds, strict=True)]
    assert measurements[1].time == pytest.approx(time_before + plants[1].period)
    np.testing.assert_allclose(measurements[1].q, measurements[0].q, atol=2e-4)  # one period of 1 ms
    assert worlds[1].physics is not plants[1].physics


def test_pushes_act_for_their_time_and_no_longer() -> None:
    plant = SteeredPlant(leg(), SharedState(), 0)
    free = SteeredPlant(leg(), SharedState(), 0)
    world, other = plant.init()[1], free.init()[1]
    frame = plant.physics.robot.frame_names[-1]  # type: ignore[union-attr]
    plant._shared.pushes.append((frame, (30.0, 0.0, 0.0), 0.02))
    acting = 0
    for _ in range(40):
        plant.step(still(plant.physics), world)  # type: ignore[arg-type]
        free.step(still(plant.physics), other)  # type: ignore[arg-type]
        acting += bool(plant._shared.acting)
    assert acting == 20
    assert not np.allclose(world.last.v, other.last.v, atol=1e-3)
    assert world.inner.pushes == []


def test_imperfections_come_and_go_while_it_moves() -> None:
    plant = SteeredPlant(leg(), SharedState(), 0)
    first, world = plant.init()
    slow = plant.built.model_copy(update={"actuation": ActuationConfig(bandwidth=5.0)})
    plant.rehearse(None, slow)
    plant._shared.requests = Requests(imperfections=slow)
    torque = np.full(plant.physics.robot.n, 2.0)  # type: ignore[union-attr]
    command = replace(still(plant.physics), torque=torque)  # type: ignore[arg-type]
    reading, world = plant.step(command, world)
    assert np.all(np.abs(reading.torque - first.torque) < 0.2)  # 5 Hz have let a thirtieth through by now
    plant._shared.requests = Requests(imperfections=plant.built)
    reading, world = plant.step(command, world)
    np.testing.assert_allclose(reading.torque, torque)


def test_what_cannot_be_built_is_refused_beforehand() -> None:
    plant = SteeredPlant(leg(), SharedState(), 0)
    late = Imperfections(computation_delay=0.0005)
    with pytest.raises(ConfigError, match="whole multiple"):
        plant.rehearse(None, late)
    physics = plant.physics
    assert physics is not None
    form = SceneForm(physics.scene)
    with pytest.raises(ConfigError, match="physics step"):
        plant.rehearse(form.changed(("floor", "stiffness"), 1e9), None)
    with pytest.raises(ConfigError, match="friction"):
        form.changed(("floor", "friction"), -1.0)


def test_what_strangers_send_is_not_printed_however_bad() -> None:
    assert not _quiet().isEnabledFor(logging.CRITICAL)


def test_the_frame_to_push_is_the_chosen_one_or_the_last() -> None:
    pushes = object.__new__(PushControls)
    pushes._frame = SimpleNamespace(options=("none",), value="none")  # type: ignore[assignment]
    pushes.offer(("shoulder", "elbow", "flange"), "elbow")
    assert pushes.frame == "elbow"
    pushes.offer(("shoulder", "elbow", "tool"), "nowhere")
    assert pushes.frame == "tool"
