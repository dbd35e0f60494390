"""What runs: task or study, case, controller, robot; of a task its tool, surface and path. Each choice starts anew."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import viser

from pliant.errors import PliantError
from pliant.experiments.base import CaseConfig
from pliant.experiments.registry import get_study, study_names
from pliant.live.link.steering_lock import SteeringLock
from pliant.live.page.changed_case import (
    PATTERNS,
    SURFACES,
    TOOLS,
    robots_for,
    with_controller,
    with_path,
    with_robot,
    with_surface,
    with_tool,
)
from pliant.live.page.form import WATCHING, tell
from pliant.studies.task.config import TaskCase
from pliant.tasks.files import catalogue

_NONE_YET: tuple[str, ...] = ("–",)
Start = Callable[[str, CaseConfig, bool], None]
"""takes study, configuration, and whether what the page turned is forgotten"""
Refuse = Callable[[str], None]
"""takes the reason why a choice cannot be"""


class Choices:
    """The controls; what cannot be chosen is refused with the reason, and the control goes back.

    Args:
        server: the page.
        steering: which browser may choose.
        start: starts a run.
        refuse: shows why none is started.
        path_folder: where the path's controls go.
    """

    def __init__(
        self,
        server: viser.ViserServer,
        steering: SteeringLock,
        start: Start,
        refuse: Refuse,
        path_folder: viser.GuiFolderHandle,
    ) -> None:
        self._steering, self._start, self._refuse = steering, start, refuse
        self._study, self._config = "", None
        gui = server.gui
        self.folder = gui.add_folder("What runs")
        """where they stand, but for those of the path"""
        with self.folder:
            self._studies = gui.add_dropdown("task", _NONE_YET, hint="A task of the catalogue, or a study.")
            self._cases = gui.add_dropdown("case", _NONE_YET, hint="Of the task or study; the first is itself.")
            self._controllers = gui.add_dropdown("controller", _NONE_YET, hint="Starts the case again at once.")
            self._robots = gui.add_dropdown("robot", _NONE_YET, hint="Starts the case again with another robot.")
            self._tools = gui.add_dropdown("tool", TOOLS, hint="What touches: a ball, or all of a cylinder or block.")
            self._surfaces = gui.add_dropdown(
                "surface",
                SURFACES,
                hint="Of the usual size, where the robot reaches it well; mesh: the task's file.",
            )
        with path_folder:
            self._path = gui.add_dropdown("path", _NONE_YET, hint="What the tool draws on the surface; starts anew.")
            self._size = gui.add_vector2(
                "size [m]", (0.0, 0.0), min=(0.0, 0.0), step=0.01, hint="Of the path, along and across; starts anew."
            )
        self._of_path = (self._tools, self._surfaces, self._path, self._size)
        pairs = (
            (self._studies, self._task_chosen), (self._cases, self._case_chosen),
            (self._controllers, self._controller_chosen), (self._robots, self._robot_chosen),
            (self._tools, self._tool_chosen), (self._surfaces, self._surface_chosen),
            (self._path, self._path_chosen), (self._size, self._path_chosen),
        )  # fmt: skip
        for control, chosen in pairs:
            control.on_update(self._guarded(chosen))

    def begin(self, study: str, config: CaseConfig, *, offered: bool) -> None:
        """Shows what runs. Args: offered: whether something else can be chosen."""
        self._study, self._config = study, config
        self.folder.visible = offered
        of_path = offered and isinstance(config, TaskCase) and not config.phase
        for control in self._of_path:
            control.visible = of_path
        if offered:
            self.fill()

    def changed(self, config: CaseConfig) -> None:
        """The configuration as it is now."""
        self._config = config

    def fill(self) -> None:
        """Puts every control to what runs."""
        config = self._config
        if config is None:
            return
        study = get_study(self._study)
        _show(self._studies, (*catalogue(), *study_names()), study.name)
        _show(self._cases, tuple(study.cases), config.case)
        _show(self._controllers, tuple(study.controllers), config.controller)
        _show(self._robots, robots_for(config), config.robot)
        if isinstance(config, TaskCase):
            self._tools.value, self._surfaces.value = config.tool.shape, config.surface.shape
            _show(self._path, PATTERNS, config.path.pattern)
            self._size.value = config.path.size

    # ------------------------------------------------------------------ what people choose

    def _task_chosen(self, config: CaseConfig) -> None:
        if self._studies.value != self._study:
            study = get_study(self._studies.value)
            self._start(study.name, study.case(next(iter(study.cases))), True)

    def _case_chosen(self, config: CaseConfig) -> None:
        if self._cases.value != config.case:
            self._start(self._study, get_study(self._study).case(self._cases.value), True)

    def _controller_chosen(self, config: CaseConfig) -> None:
        if self._controllers.value != config.controller:
            self._again(with_controller(self._study, config, self._controllers.value))

    def _robot_chosen(self, config: CaseConfig) -> None:
        if self._robots.value != config.robot:
            self._again(with_robot(config, self._robots.value))

    def _tool_chosen(self, config: CaseConfig) -> None:
        if isinstance(config, TaskCase) and self._tools.value != config.tool.shape:
            self._again(with_tool(config, self._tools.value))

    def _surface_chosen(self, config: CaseConfig) -> None:
        if isinstance(config, TaskCase) and self._surfaces.value != config.surface.shape:
            self._again(with_surface(config, self._surfaces.value))

    def _path_chosen(self, config: CaseConfig) -> None:
        if isinstance(config, TaskCase):
            along, across = (float(part) for part in self._size.value)
            if (self._path.value, (along, across)) != (config.path.pattern, config.path.size):
                self._again(with_path(config, self._path.value, (along, across)))

    def _again(self, config: CaseConfig) -> None:
        self._start(self._study, config, True)

    def _guarded(self, chosen: Callable[[CaseConfig], None]) -> Callable[[viser.GuiEvent[Any]], None]:
        def act(event: viser.GuiEvent[Any]) -> None:
            if event.client_id is None or self._config is None:
                return  # the page itself filled in what runs
            if not self._steering.allows(event.client_id):
                self.fill()
                tell(event, *WATCHING)
                return
            try:
                chosen(self._config)
            except PliantError as error:
                self.fill()
                self._refuse(str(error))

        return act


def _show(control: viser.GuiDropdownHandle[str], names: tuple[str, ...], chosen: str) -> None:
    names = names if chosen in names else (*names, chosen)  # beside the catalogue, a file of the user's
    if tuple(control.options) != names:
        control.options = names
    control.value = chosen
