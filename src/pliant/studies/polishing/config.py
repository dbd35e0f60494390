"""Typed configuration of a polishing run: what of its task file the study changes, in few numbers.

Source of the task: [FFMPC] Kleff, Jordana, Mansard, Righetti, "Force feedback in model predictive control: a soft
contact approach", 2024, sections VI and VII. What the paper leaves open (height of the table, tool, ramps) is in the
task file, `tables-2-3-4` of the catalogue.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, Literal

from pydantic import Field

from pliant.configuration import merged
from pliant.controllers.step_limit import DEFAULT_SHARE, TorqueStep
from pliant.entries import ControllerConfig
from pliant.experiments.base import CaseConfig
from pliant.quantity import quantity
from pliant.robots.rotors import RotorInertia
from pliant.simulation import Imperfections
from pliant.studies.polishing.paper_task import TASK, end_of
from pliant.studies.polishing.timetable import disturbances, phase_changes, start_pose
from pliant.studies.polishing.work_config import RepeatedPushes, Table, Work
from pliant.studies.task.build_list import listed
from pliant.studies.task.config import TaskCase


class PolishingConfig(CaseConfig):
    """One run of the polishing task."""

    controller: str = Field(default="force-feedback-mpc", description="name of the controller")
    robot: str = Field(
        default="iiwa14", description="catalogue name, or path of a URDF or MJCF file with a frame 'flange'"
    )
    locked: dict[str, float] | None = quantity(
        None,
        "rad",
        "joint → angle at which it is fixed, replaced as a whole; none: A7 of the iiwa14 as in the paper,"
        " of another robot what the catalogue locks; {}: none",
    )
    rotor_inertia: RotorInertia = quantity(
        None,
        "kg m²",
        "the motors' inertia as every joint feels it; assumed: 0.021 √(torque limit in N·m); none: 0 for"
        " the iiwa14, whose model in the paper has none, of another robot that of the catalogue or of the file",
    )
    duration: float = quantity(end_of("circle"), "s", "length of the run", gt=0.0, le=3600.0)
    period: float = quantity(TASK.simulation.period, "s", "control period", gt=0.0)
    physics_step: float = quantity(TASK.simulation.physics_step, "s", "of the simulation", gt=0.0)
    table: Table = Table()
    task: Work = Work()
    imperfections: Imperfections = Field(default=Imperfections(), description="of sensors, drives and computation")
    unknown_mass: float = quantity(0.0, "kg", "of the tool, beside its known 0.4 kg", ge=0.0, le=1e3)
    model_mass_error: float = quantity(
        0.0,
        "1",
        "share by which each link's mass is off in the controller's model, drawn uniformly within ±",
        ge=0.0,
        lt=1.0,
    )
    delay_error: float = quantity(0.0, "s", "of δ_o in controllers that predict: believed minus true", ge=-1.0, le=1.0)
    torque_step: TorqueStep = DEFAULT_SHARE
    pushes: RepeatedPushes | None = Field(default=None, description="pushes from outside; none: nobody pushes")
    preset: Literal["tuned", "perfect", "paper"] = Field(
        default="tuned",
        description="what `control` starts from: weights tuned for the imperfect robot, for a perfect one, or the"
        " weights of the paper's authors",
    )
    control: dict[str, Any] = Field(
        default={}, description="changes to the controller's parameters, e.g. control.contact.stiffness=[1e4]"
    )

    @property
    def clock(self) -> Mapping[str, float]:
        return {"period": self.period, "physics_step": self.physics_step}

    @property
    def windows(self) -> Mapping[str, tuple[float, float]]:
        task = self.task
        return {
            "first contact": (task.reach, self.duration),
            "contact breaks": (task.pressed, self.duration),
            "the work": (task.circle, self.duration),
        }

    def parameters(self) -> ControllerConfig:
        """The controller's parameters: its defaults, those of this study, what is known of the robot's delays, then
        `control`."""
        return listed(self.as_task()).parameters

    def as_task(self) -> TaskCase:
        """The task of this run: that of the file, with what is changed here.

        Raises:
            ConfigError: times that do not increase, a stop of something else than a circle, or a value that a task
                does not take.
        """
        imperfections, table = self.imperfections, self.table
        late = max(imperfections.computation_delay + self.delay_error, 0.0)
        shared = {name: getattr(self, name) for name in (*CaseConfig.model_fields, "preset", "torque_step")}
        plane = {"pose": {"xyz": (table.x, 0.0, table.height), "rpy": (math.degrees(table.tilt), 0.0, 0.0)}}
        plane |= {"stiffness": table.stiffness, "damping": table.damping, "friction": table.friction}
        changes: dict[str, Any] = {
            **shared,
            **self._arm(),
            "estimation": self.estimation.model_dump(),
            "start": start_pose(table, self.task),
            "control": {self.controller: self.control} if self.control else {},
            "simulation": {"period": self.period, "physics_step": self.physics_step},
            "timing": {"sensing_delay": imperfections.sensing.delay, "computation_delay": late},
            "truth": {
                "tool_mass": self.unknown_mass,
                "link_masses": self.model_mass_error,
                "imperfections": {"base": "none", **imperfections.model_dump()},
            },
            "scene": {"table": plane},
            "phase": phase_changes(table, self.task, self.duration),
            "disturbance": disturbances(self.pushes),
        }
        return merged(TASK, changes)

    def _arm(self) -> Mapping[str, Any]:
        """What is held still and how heavy the motors are: as in the paper of its own arm, of others what is known."""
        own = self.robot == TASK.robot
        locked = None if self.locked is None else {joint: math.degrees(at) for joint, at in self.locked.items()}
        return {
            "locked": TASK.locked if own and self.locked is None else locked,
            "rotor_inertia": TASK.rotor_inertia if own and self.rotor_inertia is None else self.rotor_inertia,
        }
