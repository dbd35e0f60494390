"""One run that people steer: the loop of a study with the desk wired in."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

from pliant.errors import ConfigError, PliantError
from pliant.experiments.base import CaseConfig, Experiment, Study
from pliant.experiments.runner import run_info
from pliant.live.link.messages import (
    Aim,
    Flaws,
    Flow,
    Looks,
    Message,
    Note,
    Parameters,
    Pull,
    PushNow,
    Ready,
    Record,
    StepOnce,
    Surroundings,
    Turned,
)  # fmt: skip
from pliant.live.loop.pace import Pace
from pliant.live.loop.recording import SwitchedRecorder
from pliant.live.loop.requests import Desk, Wishes
from pliant.live.loop.steered_controller import SteeredController, with_core
from pliant.live.loop.steered_plant import SteeredPlant
from pliant.live.loop.steered_source import steered
from pliant.live.loop.tuning import parameters_of, retuning, retuning_of_case
from pliant.live.loop.watch import Watch
from pliant.telemetry.scene_topics import DrawnScene
from pliant.visual_shapes import looks_of


class Session:
    """A wired loop, what people ask of it, and what they see of it.

    Args:
        study: that the configuration belongs to.
        config: of the run.
        send: takes a message for the page and returns at once.
        run: number of the run.
        experiment: the loop, if it was built already.
        wishes: what people asked for before it starts.
        restarts: whether the page may choose another case.

    Raises:
        PliantError: the configuration cannot be built.
        ConfigError: the plant is not one that can be drawn.
    """

    def __init__(
        self,
        study: Study[Any],
        config: CaseConfig,
        send: Callable[[Message], None],
        run: int,
        *,
        experiment: Experiment | None = None,
        wishes: Wishes | None = None,
        restarts: bool = True,
    ) -> None:
        self.study, self.config, self.built_for = study, config, config
        self._send, self._run, self._restarts = send, run, restarts
        built = self.built = experiment or study.build(config)
        self.desk = Desk()
        self.desk.wishes = wishes or Wishes()
        self.plant = SteeredPlant(built.plant, self.desk, config.seed)
        if self.plant.physics is None:
            raise ConfigError(f"the page can show simulated robots only, not a {type(built.plant).__name__}")
        self._core = built.controller
        self.experiment = replace(
            built,
            plant=self.plant,
            source=steered(built.source, self.desk),
            controller=SteeredController(built.controller, self.desk),
        )
        self.recorder = SwitchedRecorder(run_info(study, config, built), built.channels)
        self._physics = self.plant.rehearse(self.desk.wishes.scene, None) or self.plant.physics
        self.watch = Watch(send, built.robot, self._physics, self.desk, run)
        self.watch.period = built.plant.period
        self.watch.recording = lambda: self.recorder.path
        self._announced = False

    def observe(self, pace: Pace) -> None:
        """Lets the page see how time passes."""
        self.watch.report = pace.report

    def announce(self) -> None:
        """Tells the page what there is, as soon as the first tick has shown it."""
        columns, physics = self.watch.columns, self._physics
        if self._announced or columns is None:
            return
        self._announced = True
        robot = self.experiment.robot
        self._send(
            Ready(
                run=self._run,
                study=self.study.name,
                config=self.config,
                looks=looks_of(physics.model, robot.n),
                bodies=int(physics.model.nbody),
                frames=robot.frame_names,
                columns=columns.names,
                period=self.plant.period,
                scene=physics.scene,
                flaws=self.desk.wishes.flaws or self.plant.built,
                warnings=self.experiment.warnings,
                restarts=self._restarts,
            )
        )
        self.watch.refresh(now=True)

    def periods(self, seconds: float) -> Iterator[int]:
        """One item a period until so many s of the task are done, however fast it goes."""
        tick = 0
        while tick == 0 or self.desk.clock < seconds - 1.5 * self.plant.period:
            yield tick
            tick += 1

    def obey(self, message: Message, pace: Pace) -> None:
        """Does what the page asks; what cannot be done is refused with the reason, and nothing changes."""
        try:
            self._obey(message, pace)
        except PliantError as error:
            self._send(Note("refused", str(error)))

    def _obey(self, message: Message, pace: Pace) -> None:
        wishes = self.desk.wishes
        match message:
            case Flow():
                pace.flow = message
                self.watch.refresh(now=True)
            case StepOnce():
                pace.steps += message.periods
            case Aim():
                self.desk.wishes = replace(wishes, aim=message)
            case Turned():
                self.desk.wishes = replace(wishes, turned=message)
            case Pull():
                self.experiment.robot.frame_id(message.frame)
                self.desk.wishes = replace(wishes, pull=message, pulled_at=time.monotonic())
            case PushNow():
                self.experiment.robot.frame_id(message.frame)
                self.desk.pushes.append((message.frame, message.force, message.duration))
            case Parameters():
                self.retune(message.config)
            case Surroundings():
                self._surround(message)
            case Flaws():
                self.plant.rehearse(None, message.config)
                self.desk.wishes = replace(wishes, flaws=message.config)
            case Record():
                self._record(message)
            case _:
                pass

    def retune(self, config: CaseConfig) -> None:
        """Gives the controller the parameters of another configuration. Raises PliantError if it cannot have them."""
        before, after = parameters_of(self.config), parameters_of(config)
        if before is None or after is None:
            change = retuning_of_case(config)
        else:
            change = retuning(before, after, config, self.experiment.robot, self.plant.period)
        successor = None if change.controller is None else with_core(self._core, change.controller)
        wishes = self.desk.wishes
        self.desk.wishes = replace(
            wishes,
            tunings=change.tunings,
            whole=change.whole,
            controller=successor or wishes.controller,
        )
        self.config = config

    def _surround(self, message: Surroundings) -> None:
        physics = self.plant.rehearse(message.scene, None)
        if physics is None:
            return
        self.desk.wishes = replace(self.desk.wishes, scene=message.scene)
        self._physics = physics
        self.watch.show(physics)
        self._send(Looks(looks_of(physics.model, self.experiment.robot.n), message.scene))

    def _record(self, message: Record) -> None:
        if message.path is None:
            self.finish_recording()
        else:
            scene = DrawnScene(self._physics.model, self.experiment.robot.n) if self.config.log_scene else None
            self.recorder.start(message.path, run_info(self.study, self.config, self.experiment), scene)
        self.watch.refresh(now=True)

    def finish_recording(self, failure: str | None = None) -> None:
        """Ends the log, if one is written."""
        try:
            path = self.recorder.stop(failure)
        except PliantError as error:
            self._send(Note("failed", str(error)))
            return
        if path is not None:
            self._send(Note("recorded", str(path)))
