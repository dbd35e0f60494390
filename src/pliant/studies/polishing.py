"""Polishing: reach a table, press with 50 N, draw a circle under predictive control.

Source of the task: [FFMPC] Kleff, Jordana, Mansard, Righetti, "Force feedback in model predictive control: a soft
contact approach", 2024, section VI. What the paper leaves open (height of the table, tool, ramps) is in the
configuration.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import Any, Literal

import numpy as np
from pydantic import Field

from pliant.entries import ControllerEntry, find_entry
from pliant.errors import ConfigError
from pliant.estimation import WrenchEstimator
from pliant.mpc import CONTROLLERS, MpcConfig
from pliant.references.ik_mink import MinkSolver
from pliant.references.inverse_kinematics import Target, joint_box
from pliant.references.phases import Lookahead, PhasedSource, TaskPhase
from pliant.references.shapes import circle
from pliant.references.steps import Waypoints, wrench_steps
from pliant.references.trajectory import Hold
from pliant.robot import Robot, Tool
from pliant.simulation import ForceSensor, MujocoPlant, Scene, Surface, table
from pliant.spatial import Array, rpy
from pliant.studies.base import CaseConfig, Experiment, Study
from pliant.studies.config import Config, merged
from pliant.telemetry import metrics as measure
from pliant.telemetry.log import Log
from pliant.telemetry.plots.series import Curve, Panel, time_series
from pliant.telemetry.plots.style import save
from pliant.telemetry.schema import Channel
from pliant.telemetry.summary import Metric

FRAME = "tool"
BALL_RADIUS = 0.015  # m; the contact frame is its centre
_TURNED_DOWN = rpy(math.pi, 0.0, math.pi)


class Table(Config):
    """The surface that is polished. The tool comes down at y = 0."""

    height: float = Field(default=0.01, description="z of its surface", json_schema_extra={"unit": "m"})
    x: float = Field(default=0.65, description="x at which the tool comes down", json_schema_extra={"unit": "m"})
    stiffness: float = Field(default=1e4, gt=0.0, json_schema_extra={"unit": "N/m"})
    damping: float = Field(default=1e2, ge=0.0, json_schema_extra={"unit": "N·s/m"})
    friction: float = Field(default=0.25, ge=0.0, description="Coulomb coefficient", json_schema_extra={"unit": "1"})
    tilt: float = Field(default=0.0, description="about the world's x axis", json_schema_extra={"unit": "rad"})


class Task(Config):
    """What the tool does. Times count from the start of the run."""

    start: float = Field(
        default=0.10, gt=0.0, description="height over the table where the run starts", json_schema_extra={"unit": "m"}
    )
    above: float = Field(
        default=0.02, gt=0.0, description="height over the table where reach ends", json_schema_extra={"unit": "m"}
    )
    reach: float = Field(
        default=0.5, gt=0.0, description="end of the motion above the table", json_schema_extra={"unit": "s"}
    )
    touch: float = Field(
        default=1.0, gt=0.0, description="end of the descent; contact begins", json_schema_extra={"unit": "s"}
    )
    pressed: float = Field(
        default=2.0, gt=0.0, description="end of the ramp of the force", json_schema_extra={"unit": "s"}
    )
    circle: float = Field(default=3.0, gt=0.0, description="start of the circle", json_schema_extra={"unit": "s"})
    light: float = Field(default=5.0, gt=0.0, description="force at first contact", json_schema_extra={"unit": "N"})
    force: float = Field(default=50.0, gt=0.0, description="force of the circle", json_schema_extra={"unit": "N"})
    radius: float = Field(default=0.07, gt=0.0, description="of the circle", json_schema_extra={"unit": "m"})
    speed: float = Field(default=3.0, gt=0.0, description="of the circle", json_schema_extra={"unit": "rad/s"})
    ease: float = Field(
        default=0.5, gt=0.0, description="time in which the circle starts from rest", json_schema_extra={"unit": "s"}
    )
    found: bool = Field(default=False, description="contact begins when it is felt, not by the timetable")


class PolishingConfig(CaseConfig):
    """One run of the polishing task."""

    controller: str = Field(default="force-feedback-mpc", description="name of the controller")
    robot: str = Field(
        default="iiwa14", description="catalogue name, or path of a URDF or MJCF file with a frame 'flange'"
    )
    locked: dict[str, float] = Field(
        default={"A7": 0.0}, description="joint → angle at which it is fixed", json_schema_extra={"unit": "rad"}
    )
    duration: float = Field(default=10.0, gt=0.0, description="length of the run", json_schema_extra={"unit": "s"})
    period: float = Field(default=1e-3, gt=0.0, description="control period", json_schema_extra={"unit": "s"})
    physics_step: float = Field(default=5e-4, gt=0.0, json_schema_extra={"unit": "s"})
    table: Table = Table()
    task: Task = Task()
    preset: Literal["tuned", "paper"] = Field(
        default="tuned",
        description="what `control` starts from: tuned for this plant, or the weights of the paper's authors",
    )
    control: dict[str, Any] = Field(
        default={}, description="changes to the controller's parameters, e.g. control.contact.stiffness=[1e4]"
    )

    @property
    def entry(self) -> ControllerEntry[Any]:
        """The chosen controller."""
        return find_entry(CONTROLLERS, self.controller)

    def parameters(self) -> MpcConfig:
        """The controller's parameters: its defaults, those of this study, then `control`."""
        changes = TUNED.get(self.controller, {}) if self.preset == "tuned" else {}
        return merged(merged(self.entry.default, changes), self.control)


_COSTS = {"posture": {"weight": 0.002}, "torque": {"weight": 1e-5}}
_PLANE = {"translation": {"weight": 50.0, "activation": (1.0, 1.0, 0.0)}}
_PHASES = {"ramp": _PLANE, "contact": _PLANE, "circle": {"translation": {"weight": 2000.0}}}

TUNED: Mapping[str, Mapping[str, Any]] = {
    "force-feedback-mpc": {
        "contact": {"stiffness": (3e3,), "damping": (70.0,)},
        "costs": {**_COSTS, "force": {"weight": 0.1, "terminal": 0.5}},
        "phases": _PHASES,
    },
    "torque-feedback-mpc": {"costs": _COSTS, "phases": _PHASES},
    "classical-mpc": {"costs": _COSTS, "phases": _PHASES},
}
"""controller → changes to its defaults for this plant, each found by the same sweep of posture, torque and position
weights; preset "paper" leaves the defaults as they are"""


class Polishing(Study[PolishingConfig]):
    """The study."""

    name = "polishing"
    title = "press on a table and draw a circle: classical, torque-feedback and force-feedback MPC"
    cases = MappingProxyType({"ideal": PolishingConfig(case="ideal")})

    controllers = tuple(CONTROLLERS)

    def runs(self, case: str, seeds: int | None = None) -> Sequence[PolishingConfig]:
        tuned = [self.case(case).model_copy(update={"controller": name}) for name in CONTROLLERS]
        return [
            *tuned,
            *(config.model_copy(update={"preset": "paper", "variant": "paper-weights"}) for config in tuned),
        ]

    def build(self, config: PolishingConfig) -> Experiment:
        robot = Robot.load(config.robot, locked=config.locked, tool=Tool(frame=FRAME)).with_contact(FRAME, BALL_RADIUS)
        parameters = config.parameters()
        controller = config.entry.build(robot, parameters, config.period)
        channels: Mapping[str, Any] = getattr(controller, "channels", {})
        surface = Surface(config.table.stiffness, config.table.damping, config.table.friction)
        point = (config.table.x, 0.0, config.table.height)
        plant = MujocoPlant(
            robot,
            Scene((table(point, config.table.tilt, surface),)),
            period=config.period,
            physics_step=config.physics_step,
            start=_start(config, robot),
            sensors=[ForceSensor(FRAME)],
            observe=[FRAME],
        )
        return Experiment(
            robot=robot,
            plant=plant,
            estimator=WrenchEstimator(robot),
            source=polishing_source(config, robot, Lookahead(parameters.horizon, parameters.dt)),
            controller=controller,
            channels=tuple(Channel(name, about.unit) for name, about in channels.items()),
            warnings=config.entry.advise(robot, parameters, config.period),
        )

    def metrics(self, config: PolishingConfig, log: Log) -> tuple[Metric, ...]:
        """On the true signals, from the start of the circle."""
        time = log.time(f"truth/{FRAME}/wrench")
        circling = measure.between(time, config.task.circle)
        touching = measure.between(time, config.task.pressed)
        landing = measure.between(time, config.task.reach, config.task.touch + 0.1)
        force = log[f"truth/{FRAME}/wrench"][:, 2]
        wanted = log[f"reference/{FRAME}/wrench"][:, 2]
        position, reference = log[f"truth/{FRAME}/position"][:, :2], log[f"reference/{FRAME}/position"][:, :2]
        best = (config.case, config.controller, config.preset) == ("ideal", "force-feedback-mpc", "tuned")
        return (
            Metric("E_λ", measure.mae(force[circling], wanted[circling]), "N", target=0.5 if best else None),
            Metric(
                "E_P", 1e3 * measure.mae(position[circling], reference[circling]), "mm", target=1.0 if best else None
            ),
            Metric("λ_max", measure.peak(force[circling]), "N"),
            Metric("t_break", 100.0 * measure.break_share(force[touching]), "%", target=0.0 if best else None),
            Metric("first contact peak", measure.peak(force[landing]), "N"),
            Metric("KKT reached", 100.0 * float(np.mean(log["mpc/status"] == 0.0)), "%"),
            Metric("iterations", float(np.mean(log["mpc/iterations"])), "1"),
        )

    def figures(self, config: PolishingConfig, experiment: Experiment, log: Log, folder: Path) -> list[Path]:
        time = log.time(f"truth/{FRAME}/wrench")
        force, wanted = log[f"truth/{FRAME}/wrench"][:, 2], log[f"reference/{FRAME}/wrench"][:, 2]
        error = 1e3 * (log[f"truth/{FRAME}/position"] - log[f"reference/{FRAME}/position"])
        panels = [
            Panel("normal force, N", [Curve("true", time, force), Curve("reference", time, wanted, "reference")]),
            Panel("position error, mm", [Curve("xy"[axis], time, error[:, axis]) for axis in range(2)]),
            Panel("SQP iterations", [Curve("", log.time("mpc/iterations"), log["mpc/iterations"])]),
        ]
        made = time_series(panels, title=f"{config.case}, {config.controller}", phases=log.phases())
        return [save(made, folder / f"{config.case}_{config.controller}_seed{config.seed}.png")]


def polishing_source(config: PolishingConfig, robot: Robot, lookahead: Lookahead) -> PhasedSource:
    """References of the task: reach, track (descend), ramp, contact (hold), circle.

    Raises:
        ConfigError: times that do not increase.
    """
    task = config.task
    ends = [task.reach, task.touch, task.pressed, task.circle]
    if any(late <= early for early, late in zip([0.0, *ends], ends, strict=False)):
        raise ConfigError(f"reach, touch, pressed and circle must increase, got {ends}")
    surface = _touching(config)
    start, above = surface + np.array([0.0, 0.0, task.start]), surface + np.array([0.0, 0.0, task.above])
    descent = task.touch - task.reach
    below = surface - np.array([0.0, 0.0, task.above])  # where a descent that nothing stops would end
    down = [above, surface, below] if task.found else [above, surface]
    times = [0.0, descent, 2.0 * descent][: len(down)]
    at_touch = Hold(np.zeros(3))
    rising = wrench_steps([0.0, task.pressed - task.touch], [task.light, task.force], shape="ramp")
    pressing = wrench_steps([0.0], [task.force])
    turn = circle(np.zeros(3), task.radius, task.speed).eased(task.ease)
    phases = (
        TaskPhase("reach", Waypoints([0.0, task.reach], [start, above]), duration=task.reach),
        TaskPhase("track", Waypoints(times, down), duration=descent, ends_on_contact=task.found),
        TaskPhase("ramp", at_touch, "touch", rising, task.pressed - task.touch, touches=True),
        TaskPhase("contact", at_touch, "touch", pressing, task.circle - task.pressed, touches=True),
        TaskPhase("circle", turn, "touch", pressing, touches=True),
    )
    return PhasedSource(robot, FRAME, phases, _TURNED_DOWN, lookahead, robot.home)


def _touching(config: PolishingConfig) -> Array:
    """(3,) m, centre of the ball where it just touches the table."""
    return np.array([config.table.x, 0.0, config.table.height + BALL_RADIUS])


def _start(config: PolishingConfig, robot: Robot) -> Array:
    """(n,) rad: the paper's configuration with the tool turned down and lifted, for there it stands in the table.

    Raises:
        ConfigError: the robot cannot take that pose.
    """
    solver = MinkSolver(robot, FRAME)
    target = Target(_touching(config) + np.array([0.0, 0.0, config.task.start]), _TURNED_DOWN)
    q = solver.solve(robot.home, robot.home, joint_box(robot), target)
    distance, angle = solver.shortfall(q, target)
    if distance > 1e-3 or angle > 1e-2:
        raise ConfigError(
            f"robot {robot.name!r} must reach {np.round(target.position, 3).tolist()} m with its tool pointing down: it"
            f" misses by {1e3 * distance:.1f} mm and {angle:.2f} rad"
        )
    return q


STUDY = Polishing()
