"""Identifies the tool on a force/torque sensor: moves the arm through poses and fits mass, centre and bias."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from pydantic import Field

from pliant import loop
from pliant.configuration import Config
from pliant.errors import RobotError, RunFailedError, options
from pliant.estimation import DirectEstimator, ToolIdentification, identification_poses, identify_tool
from pliant.estimation.identification_poses import JOINTS, POSES, SHARE
from pliant.interfaces import Controller, Estimator, Plant
from pliant.quantity import quantity
from pliant.references.postures.posture_tour import PostureTour
from pliant.robot import Robot
from pliant.signals import Tick
from pliant.spatial import Array


class IdentifyToolConfig(Config):
    """How the arm moves and when it is read."""

    sensor_frame: str = Field(default="flange", description="frame of the force/torque sensor")
    task_frame: str | None = Field(default=None, description="frame of the reference's task; None: the sensor's")
    poses: int = Field(default=POSES, ge=4, le=1000, description="number of poses; more make the uncertainty smaller")
    joints: int = Field(default=JOINTS, ge=1, le=100, description="how many of the last joints move")
    share: float = quantity(SHARE, "1", "of each joint's range that is used", gt=0.0, le=1.0)
    lowest: float | None = quantity(None, "m", "least height of the sensor; None: 0.1 m below home", ge=-10.0, le=10.0)
    move: float = quantity(2.0, "s", "from pose to pose", ge=0.01, le=1e3)
    settle: float = quantity(0.6, "s", "rest before reading", ge=0.01, le=1e3)
    average: float = quantity(0.4, "s", "reading", ge=0.01, le=1e3)
    still: float = quantity(0.02, "rad/s", "largest mean joint speed while reading", gt=0.0)
    seed: int = Field(default=0, ge=0, description="of the choice of poses")


class Reading(NamedTuple):
    """The mean over one rest."""

    wrench: Array
    """(6,) the sensor's axes"""
    q: Array
    """(n,) rad"""
    v: Array
    """(n,) rad/s"""


def identification_tour(robot: Robot, config: IdentifyToolConfig) -> PostureTour:
    """The motion of an identification, from the robot's home. Look at it before running it on hardware."""
    postures = identification_poses(
        robot,
        config.sensor_frame,
        config.poses,
        joints=config.joints,
        share=config.share,
        lowest=config.lowest,
        seed=config.seed,
    )
    return PostureTour(
        robot, config.task_frame or config.sensor_frame, postures, config.move, config.settle + config.average
    )


def run_identification(
    robot: Robot,
    plant: Plant[Any],
    controller: Controller[Any],
    config: IdentifyToolConfig | None = None,
    estimator: Estimator[Any] | None = None,
) -> ToolIdentification:
    """Runs the poses and fits. The controller need not hold them exactly: the measured joints say how gravity points.

    Args:
        robot: kinematics of the arm.
        plant: simulated or real, standing at the robot's home, touching nothing, its sensor at `config.sensor_frame`.
        controller: follows the tour; it should know the tool roughly, or be stiff enough to carry it.
        config: how the arm moves.
        estimator: what the controller sees; None: the joint signals as measured.

    Raises:
        RunFailedError: the loop stopped early, or the arm still moved while it was read.
        RobotError: the plant has no sensor at the frame.
        ConfigError: poses that do not excite.
    """
    config = config or IdentifyToolConfig()
    tour = identification_tour(robot, config)
    collector = _Collector(tour, config)
    ticks = range(round(tour.duration / plant.period))
    outcome = loop.run(plant, estimator or DirectEstimator(), tour, controller, ticks, [collector])
    if outcome.failure is not None:
        raise RunFailedError(f"the identification stopped early: {outcome.failure}")
    readings = collector.readings()
    for index, reading in enumerate(readings):
        speed = float(np.max(np.abs(reading.v)))
        if speed > config.still:
            raise RunFailedError(
                f"the arm still moved at pose {index}: {speed:.3g} rad/s, at most {config.still:g} while it is read;"
                " give it a longer `settle`, or a controller that holds still"
            )
    rotations = [robot.placement(reading.q, config.sensor_frame)[1] for reading in readings]
    gravity = np.array(robot.model.gravity.linear)
    return identify_tool([reading.wrench for reading in readings], rotations, gravity)


def report(found: ToolIdentification) -> str:
    """The result in Markdown: value and standard uncertainty, one row each."""
    rows = [("mass", found.mass, found.mass_std, "kg")]
    if found.center is not None and found.center_std is not None:
        centers = zip("xyz", found.center, found.center_std, strict=True)
        rows += [(f"centre {axis}", 1e3 * value, 1e3 * std, "mm") for axis, value, std in centers]
    names = [f"bias {kind}{axis}" for kind in "fm" for axis in "xyz"]
    units = ["N"] * 3 + ["N·m"] * 3
    rows += zip(names, found.bias.tolist(), found.bias_std.tolist(), units, strict=True)
    lines = [f"| {name} | {value:.4g} | {std:.2g} | {unit} |" for name, value, std, unit in rows]
    foot = f"noise of a pose {found.noise[0]:.3g} N, {found.noise[1]:.3g} N·m; condition number {found.condition:.3g}"
    return "\n".join(["| quantity | value | std. uncertainty | unit |", "|---|---|---|---|", *lines, "", foot])


class _Collector:
    """Sums what is measured during the last part of each rest."""

    def __init__(self, tour: PostureTour, config: IdentifyToolConfig) -> None:
        self._windows = [(end - config.average, end) for _, end in tour.rests()]
        self._frame = config.sensor_frame
        self._samples: list[list[Reading]] = [[] for _ in self._windows]
        self._start: float | None = None

    def __call__(self, tick: Tick) -> None:
        measurement = tick.measurement
        self._start = measurement.time if self._start is None else self._start
        wrench = measurement.wrenches.get(self._frame)
        if wrench is None:
            known = options(measurement.wrenches, self._frame)
            raise RobotError(f"the plant has no force/torque sensor at frame {self._frame!r}; {known}")
        elapsed = measurement.time - self._start
        for window, samples in zip(self._windows, self._samples, strict=True):
            if window[0] <= elapsed < window[1]:
                samples.append(Reading(wrench, measurement.q, measurement.v))

    def readings(self) -> list[Reading]:
        """One mean per rest. Raises RunFailedError if a rest was shorter than a control period."""
        if not all(self._samples):
            raise RunFailedError("a rest held no sample: `average` must be longer than the control period")
        return [Reading(*(np.mean(np.array(part), axis=0) for part in zip(*s, strict=True))) for s in self._samples]
