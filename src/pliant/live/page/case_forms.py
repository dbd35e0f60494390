"""Controls made from configurations: controller parameters, surfaces, the robot's imperfections, the whole case."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import viser

from pliant.configuration import merged
from pliant.entries import ControllerConfig
from pliant.experiments.base import CaseConfig
from pliant.live.link.messages import Message, NewImperfections, Parameters, Ready, Surroundings
from pliant.live.link.steering_lock import SteeringLock
from pliant.live.loop.tuning import online_fields, online_group, parameters_of, wiring_of
from pliant.live.page.basic import is_basic_parameter, is_basic_value
from pliant.live.page.choices import Choices
from pliant.live.page.fields import Path as Place
from pliant.live.page.fields import group_of, nested
from pliant.live.page.form import Form
from pliant.live.page.run_controls import RunControls
from pliant.live.page.world_form import SceneForm
from pliant.simulation import Imperfections

_NOT_A_FORM = frozenset({"case", "controller", "control", "variant"})


@dataclass(frozen=True)
class FormPlaces:
    """Where each form goes."""

    tuning: viser.GuiTabHandle
    surfaces: viser.GuiFolderHandle
    robot: viser.GuiTabHandle
    case: viser.GuiTabHandle


class CaseForms:
    """The forms of the run that is shown.

    Args:
        gui: the page.
        steering: which browser may change values.
        send: takes a message for the loop.
        run: starts a run.
        choices: told a changed configuration.
        places: where the forms go.
    """

    def __init__(
        self,
        gui: viser.GuiApi,
        steering: SteeringLock,
        send: Callable[[Message], None],
        run: RunControls,
        choices: Choices,
        places: FormPlaces,
    ) -> None:
        self._gui, self._steering, self._send, self._places = gui, steering, send, places
        self._run, self._choices = run, choices
        self._forms: list[Any] = []
        self._case_forms: list[Any] = []
        self.config: CaseConfig | None = None
        """the present configuration; None before the first run"""
        self._study = ""
        self._suited: ControllerConfig | None = None
        self._wanted: CaseConfig | None = None
        self._scene: SceneForm | None = None
        self._imperfections: Imperfections | None = None

    def begin(self, ready: Ready) -> None:
        """A run begins."""
        self.config, self._study, self._suited = ready.config, ready.study, ready.parameters

    def rebuild(self, ready: Ready) -> None:
        """Makes the forms anew, for another run than the one before."""
        for form in self._forms:
            form.remove()
        self._forms = []
        self._tuning_form(ready)
        self._scene = None if ready.scene is None else SceneForm(ready.scene)
        if self._scene is not None and ready.scene is not None and ready.scene.things:
            with self._places.surfaces:
                self._forms.append(Form(self._gui, self._steering, self._scene.group(), self._change_scene))
        self._imperfections = ready.imperfections
        if ready.imperfections is not None:
            imperfections = group_of(ready.imperfections, skip=frozenset({"joint_damping"}))
            with self._places.robot:
                self._forms.append(
                    Form(self._gui, self._steering, imperfections, self._change_imperfections, expanded=False)
                )
        if ready.restarts and not self._asked_for(ready):
            self._case_form(ready.config)

    def _asked_for(self, ready: Ready) -> bool:
        """Whether the form of the case asked for this run: it stays as it is."""
        return ready.study == self._study and self._wanted is not None and _same(self._wanted, ready.config)

    def _tuning_form(self, ready: Ready) -> None:
        config, parameters, gui = ready.config, ready.parameters, self._gui
        with self._places.tuning:
            if parameters is not None and "control" in type(config).model_fields:
                change, group = self._change_parameters, group_of(parameters)
                self._forms.append(Form(gui, self._steering, group, change, basic=is_basic_parameter))
            elif online_fields(config):
                self._forms.append(Form(gui, self._steering, online_group(config), self._change_online))
            else:
                self._forms.append(gui.add_markdown("This controller has no parameters that can be changed."))

    def _case_form(self, config: CaseConfig) -> None:
        for form in self._case_forms:
            form.remove()
        self._wanted = config
        with self._places.case:
            button = self._gui.add_button(
                "Start with these values", icon=viser.Icon.PLAYER_PLAY, hint="Builds the case anew."
            )
            group, change = group_of(config, skip=_NOT_A_FORM), self._change_case
            form = Form(self._gui, self._steering, group, change, expanded=False, basic=is_basic_value)
        self._case_forms = [button, form]
        button.on_click(self._start_wanted)

    def _start_wanted(self, event: viser.GuiEvent[Any]) -> None:
        if self._wanted is not None and self._study and self._steering.allows(event.client_id):
            control = getattr(self.config, "control", None)
            wanted = self._wanted if control is None else merged(self._wanted, {"control": control})
            self._run.start(self._study, wanted, False)

    def _change_parameters(self, place: Place, value: Any) -> None:
        if self.config is None:
            return
        above = ("control", self.config.controller) if self.config.control_by_name else ("control",)
        self._retune(merged(self.config, nested((*above, *place), value)))

    def _change_online(self, place: Place, value: Any) -> None:
        if self.config is not None:
            self._retune(merged(self.config, nested(place, value)))

    def _retune(self, config: CaseConfig) -> None:
        parameters_of(config, self._suited)  # raises an error if the parameters do not fit together
        self.config = config
        self._run.changed(config)
        self._choices.changed(config)
        self._send(Parameters(config))

    def _change_scene(self, place: Place, value: Any) -> None:
        if self._scene is not None:
            self._send(Surroundings(self._scene.changed(place, value)))

    def _change_imperfections(self, place: Place, value: Any) -> None:
        if self._imperfections is not None:
            self._imperfections = merged(self._imperfections, nested(place, value))
            self._send(NewImperfections(self._imperfections))

    def _change_case(self, place: Place, value: Any) -> None:
        if self._wanted is not None:
            self._wanted = merged(self._wanted, nested(place, value))


def _same(one: CaseConfig, other: CaseConfig) -> bool:
    return type(one) is type(other) and wiring_of(one) == wiring_of(other)
