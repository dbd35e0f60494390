"""The configuration of one run of a task file."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from pliant.configuration import merged, refuse_unknown_keys
from pliant.controllers.step_limit import DEFAULT_SHARE, TorqueStep
from pliant.entries import Believed, ControllerConfig, ControllerEntry
from pliant.errors import ConfigError
from pliant.experiments.base import CaseConfig
from pliant.experiments.base_config import Dial
from pliant.mpc.config import MpcConfig
from pliant.mpc.presets import PRESETS
from pliant.quantity import quantity
from pliant.references.surface_task import SurfaceTaskSettings
from pliant.robot import Robot
from pliant.surfaces import SurfaceGeometry
from pliant.tasks.task import Task, TaskParts
from pliant.wiring.registry import find_controller
from pliant.wiring.wire import parameters_for

_WHOLE = 3600.0  # s


class TaskCase(TaskParts, CaseConfig):
    """A task with the robot, the controller and the seed of one run."""

    duration: float = quantity(
        _WHOLE, "s", "after which the run ends in any case; by default the whole path is run", gt=0.0, le=_WHOLE
    )
    torque_step: TorqueStep = DEFAULT_SHARE

    @property
    def control_by_name(self) -> bool:
        return True

    @property
    def dials(self) -> tuple[Dial, ...]:
        """Largest force, and the speed of a path; up to the limits, or to twice of it where there is none."""
        wrenches = [one.last_wrench[:3] for one in self.phase if one.last_wrench is not None]
        force = max((math.hypot(*wrench) for wrench in wrenches), default=0.0) if self.phase else self.force.largest
        dials = [] if force == 0.0 else [Dial("force", "N", force, self.limits.force or 2.0 * force)]
        if not self.phase:
            dials.append(Dial("speed", "m/s", self.path.speed, self.limits.speed or 2.0 * self.path.speed))
        return tuple(dials)

    @property
    def entry(self) -> ControllerEntry[Any]:
        """The chosen controller."""
        return find_controller(self.controller)

    def believed(self, surface: SurfaceGeometry) -> Believed:
        """What the controller may know; nothing of `truth`. Args: surface: as it is believed."""
        return Believed(
            frames=(self.tool.frame,),
            period=self.simulation.period,
            presses=self.tool.frame,
            surface=surface,
            stiffness=self.surface.stiffness,
            damping=self.surface.damping,
            compensation=self.compensates,
            sensing_delay=self.timing.sensing_delay,
            computation_delay=self.timing.computation_delay,
            noise_force=self.estimation.noise_force,
            phases=SurfaceTaskSettings().touches,
        )

    def controller_parameters(self, robot: Robot, believed: Believed) -> ControllerConfig:
        """The controller's parameters: its defaults, weights tuned for a late or a prompt loop, what suits the task,
        then `control`. Raises ConfigError: `control` names a controller, or a key of one, that there is not."""
        for name, changes in self.control.items():
            if ":" not in name and name != self.controller:  # one of a file is looked for when it is chosen
                _refuse_unknown(name, changes)
        entry = self.entry
        late = self.timing.delay > 0.0
        preset = self.preset or ("tuned" if late else "perfect")
        base = merged(entry.default, PRESETS[preset].get(self.controller, {}))
        if isinstance(base, MpcConfig):
            as_in = {name: one.like for name, one in zip(self.phase_names(), self.phase, strict=True)}
            known = {name: base.phases[like].model_dump() for name, like in as_in.items() if like in base.phases}
            base = merged(base, {"phases": known} if known else {})
        return parameters_for(entry, robot, believed, self.control.get(self.controller, {}), base)


def _refuse_unknown(name: str, changes: Mapping[str, Any]) -> None:
    """Raises ConfigError for a controller that there is not, or parameters that it does not have."""
    entry = find_controller(name)
    try:
        refuse_unknown_keys(type(entry.default), changes)
    except ConfigError as error:
        raise ConfigError(f"control.{name}: {error}") from None


def case_of(task: Task, name: str) -> TaskCase:
    """The run of a task that is called `name`."""
    values = task.model_dump()
    return TaskCase.model_validate({**values, "case": name})
