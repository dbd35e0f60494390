"""What a phase asks of each axis of its frame: a motion, a force (0 N is a request, too), or nothing."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from pliant import run
from pliant.axis_modes import AxisModes, modes_of_wrench
from pliant.errors import ConfigError, ShapeError
from pliant.interfaces import ReferenceSource
from pliant.references.exploration.haptic_exploration import HapticExploration
from pliant.signals import Estimate, ImpedanceTuning, Reference, TaskReference
from pliant.spatial import Array, exp3
from pliant.studies.task.measure_list import within
from pliant.studies.task.study import of_value
from pliant.tasks.task import Task

TURN = exp3(np.array([0.3, -0.6, 0.2]))


def against_a_wall(modes: tuple[str, ...], controller: str = "haptic", **more: Any) -> Task:
    """The tool is asked to stand 5 mm inside a wall that stands before it along x, for as long as a phase lasts."""
    wall = {"shape": "plane", "pose": {"xyz": (0.76, 0.0458, 0.02), "rpy": (0.0, -90.0, 0.0)}}
    values: dict[str, Any] = {
        "robot": "iiwa14",
        "controller": controller,
        "timing": {"sensing_delay": 0.0, "computation_delay": 0.0},
        "scene": {"wall": wall},
        "phase": [
            {
                "name": "stay",
                "target": (0.75, 0.0458, 0.0233),
                "wrench": (0.0, 0.0, 0.0),
                "modes": modes,
                "settle": 0.8,
                "duration": 1.0,
            }
        ],
    }
    return Task.model_validate({**values, **more})


def wall_force(task: Task) -> float:
    """N, largest along x after the phase has settled."""
    made = run(task)
    assert made.failure is None or made.failure.startswith("no contact: frame"), made.failure
    inside = within(made.log, made.log.time("measurement/q"), "stay", 0.8)
    return float(np.abs(made.log["truth/tool/wrench"][inside, 0]).max())


@pytest.mark.study
@pytest.mark.parametrize("controller", ["haptic", "operational-space", "offset-free-mpc", "force-feedback-mpc"])
def test_a_force_of_zero_is_a_request(controller: str) -> None:
    free = ("free", "free", "free")
    assert wall_force(against_a_wall(("motion", "motion", "motion", *free), controller)) > 2.0  # the control
    assert wall_force(against_a_wall(("force", "motion", "motion", *free), controller)) < 1.0
    assert wall_force(against_a_wall(("free", "motion", "motion", *free), controller)) < 1.0


class Fixed(ReferenceSource[None]):
    """Says the same task for ever."""

    def __init__(self, task: TaskReference) -> None:
        self.task = task

    def init(self, estimate: Estimate) -> None:
        return None

    def step(self, estimate: Estimate, state: None) -> tuple[Reference, None]:
        return Reference(estimate.time, (self.task,)), None


def shifted(modes: AxisModes | None, wrench: Array, felt: Array, ticks: int = 100) -> Array:
    """(3,) m by which exploration has moved a target, against a force that stays whatever it does."""
    tuning = ImpedanceTuning(np.full(3, 2000.0), np.full(3, 60.0), np.full(3, 0.04))
    task = TaskReference("tool", np.zeros(3), wrench=wrench, tuning=tuning, modes=modes)
    source = HapticExploration(Fixed(task))
    zero, found = np.zeros(7), np.zeros(3)
    state = None
    for tick in range(ticks):
        estimate = Estimate(1e-3 * tick, zero, zero, zero, zero, wrenches={"tool": felt})
        state = source.init(estimate) if state is None else state
        reference, state = source.step(estimate, state)
        found = reference.tasks[0].position
    return found


def test_exploration_in_turned_axes_is_exploration_in_the_worlds_turned() -> None:
    wrench, felt = np.array([0.0, 0.0, 20.0, 0, 0, 0]), np.array([3.0, -2.0, 12.0, 0, 0, 0])
    modes = modes_of_wrench(wrench.tolist(), oriented=False)
    level = shifted(AxisModes(modes), wrench, felt)
    both = [np.concatenate([TURN @ one[:3], TURN @ one[3:]]) for one in (wrench, felt)]
    turned = shifted(AxisModes(modes, TURN), *both)
    np.testing.assert_allclose(turned, TURN @ level, atol=1e-12)
    np.testing.assert_allclose(level, shifted(None, wrench, felt), atol=0.0)  # what the wrench says anyway
    assert np.linalg.norm(level) > 1e-3
    assert np.linalg.norm(shifted(None, *both) - turned) > 1e-3  # the control: the world's axes do something else


def test_bounds_along_force_axes_hold_the_target() -> None:
    wrench, felt = np.array([0.0, 0.0, 50.0, 0, 0, 0]), np.array([0.0, 0.0, 5.0, 0, 0, 0])
    modes = modes_of_wrench(wrench.tolist(), oriented=False)
    assert abs(shifted(AxisModes(modes), wrench, felt)[2]) > 0.004
    assert abs(shifted(AxisModes(modes, deviation=0.004), wrench, felt)[2]) == pytest.approx(0.004)
    assert abs(shifted(AxisModes(modes, speed=0.02), wrench, felt)[2]) == pytest.approx(0.02 * 0.1, rel=0.1)


def limited(limit: dict[str, float]) -> Task:
    """Falls short of a floor that lies 30 mm lower than it is told."""
    phase = {
        "name": "down",
        "target": (0.7506, 0.0458, -0.03),
        "wrench": (0.0, 0.0, 10.0),
        "limit": limit,
        "until": {"any": [{"contact": True}, {"timeout": 2.0}]},
    }
    return against_a_wall(("motion",) * 6, scene={}, phase=[phase])


def test_a_phase_that_leaves_its_deviation_has_failed() -> None:
    made = run(limited({"deviation": 0.02}))
    assert made.failure is not None
    assert "'down' moved 20." in made.failure
    assert "limit.deviation allows 20 mm" in made.failure
    far = run(limited({"deviation": 0.2}))
    assert far.failure is not None
    assert "did not end within 2 s" in far.failure


def test_the_speed_along_force_axes_is_bounded_and_that_of_the_rest_is_not() -> None:
    made = run(limited({"speed": 0.03}))
    velocity = made.log["reference/tool/velocity"]
    assert np.abs(velocity[:, 2]).max() == pytest.approx(0.03, rel=1e-3)
    unbounded = run(limited({"deviation": 0.2})).log["reference/tool/velocity"]
    assert np.abs(unbounded[:, 2]).max() > 0.1


def test_modes_that_contradict_are_refused() -> None:
    with pytest.raises(ShapeError, match="axis modes are six"):
        AxisModes(("motion",))
    with pytest.raises(ConfigError, match="deviation along force axes must be above zero, got 0"):
        AxisModes(("motion",) * 6, deviation=0.0)
    task = against_a_wall(("motion",) * 6)
    idle = Task.model_validate(
        {**task.model_dump(), "phase": [{**task.phase[0].model_dump(), "limit": {"speed": 1.0}}]}
    )
    study = of_value(idle, "idle")
    with pytest.raises(ConfigError, match="limit is of the motion along force axes, and it has none"):
        study.build(study.case("idle"))


def test_a_wrench_gives_a_force_to_its_axes_alone() -> None:
    modes = AxisModes(modes_of_wrench([0.0, 0.0, 5.0, 0, 0, 0], oriented=True), TURN)
    assert modes.modes == ("motion", "motion", "force", "motion", "motion", "motion")
    assert modes.pressing(np.array([*(7.0 * TURN[:, 2]), 0, 0, 0])) is modes
    more = modes.pressing(np.array([*(7.0 * TURN[:, 0]), *(0.5 * TURN[:, 1])]))
    assert more.modes == ("force", "motion", "force", "motion", "force", "motion")


def test_a_predictive_controller_says_which_axes_it_does_not_follow() -> None:
    def said(modes: tuple[str, ...], controller: str) -> list[str]:
        study = of_value(against_a_wall(modes, controller), "wall")
        return [text for text in study.build(study.case("wall")).warnings if "will not be held" in text]

    free = ("free", "free", "free")
    asked = ("force", "free", "motion", "force", "free", "motion")
    (text,) = said(asked, "offset-free-mpc")
    assert "phase 'stay' (about x, about y)" in text  # at home no axis of the tool is the world's
    (text,) = said(asked, "classical-mpc")  # that does not predict from the measured force
    assert "phase 'stay' (x, about x, about y)" in text
    assert said(("force", "free", "motion", *free), "offset-free-mpc") == []
    assert said(("motion", "motion", "motion", *free), "offset-free-mpc") == []
    assert said(asked, "haptic") == []
    study = of_value(against_a_wall(("force", "free", "motion", *free), "haptic-paper"), "wall")
    warnings = study.build(study.case("wall")).warnings
    assert any("takes 0 N for no request" in text and "phase 'stay' (x)" in text for text in warnings)


@pytest.mark.study
def test_a_predictive_controller_presses_on_a_floor_and_yields_to_a_wall() -> None:
    """15 N on a floor while the target stands 6 mm inside a wall along x."""

    def forces(along_x: str) -> Array:
        modes = (along_x, "motion", "force", "free", "free", "free")
        floor = {"shape": "plane", "pose": {"xyz": (0.75, 0.0458, -0.0117)}, "friction": 0.1}
        wall = {"shape": "plane", "pose": {"xyz": (0.771, 0.0458, 0.0), "rpy": (0.0, -90.0, 0.0)}, "friction": 0.1}
        touching = {"until": {"any": [{"force": 12.0}, {"timeout": 3.0}]}}
        down = {"name": "down", "target": (0.745, 0.0458, -0.0017), "wrench": (0.0, 0.0, 15.0), **touching}
        corner = {"name": "corner", "target": (0.762, 0.0458, -0.0017), "modes": modes, "duration": 0.9}
        scene = {"floor": floor, "wall": wall}
        made = run(against_a_wall(modes, "force-feedback-mpc", scene=scene, phase=[down, corner]))
        assert made.failure is None, made.failure
        inside = within(made.log, made.log.time("measurement/q"), "corner", 0.7)
        return np.asarray(made.log["truth/tool/wrench"][inside, :3])

    yielding = forces("force")
    assert np.abs(yielding[:, 0]).max() < 0.3
    np.testing.assert_allclose(yielding[:, 2], 15.0, atol=0.3)
    assert np.abs(forces("motion")[:, 0]).min() > 20.0  # the control
