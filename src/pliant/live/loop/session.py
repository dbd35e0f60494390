"""One run with a live page: the loop of a study inside wrappers that carry out the requests of the page."""

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
    Flow,
    Message,
    NewImperfections,
    Note,
    Parameters,
    Pull,
    PushNow,
    Ready,
    Record,
    SceneChanged,
    StepOnce,
    Surroundings,
    TaskScaling,
)  # fmt: skip
from pliant.live.loop.pace import Pace
from pliant.live.loop.recording import SwitchedRecorder
from pliant.live.loop.requests import Requests, SharedState
from pliant.live.loop.steered_controller import SteeredController, core_of, with_core
from pliant.live.loop.steered_plant import SteeredPlant
from pliant.live.loop.steered_source import steered
from pliant.live.loop.tuning import parameters_of, retuning, retuning_of_case
from pliant.live.loop.watch import Watch
from pliant.telemetry.scene_topics import DrawnScene
from pliant.visual_shapes import looks_of


class Session:
    """A wired loop, the requests of the page, and what the page shows.

    Args:
        study: that the configuration belongs to.
        config: of the run.
        send: takes a message for the page and returns at once.
        run: number of the run.
        experiment: the loop, if it was built already.
        requests: requests from before the start.
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
        requests: Requests | None = None,
        restarts: bool = True,
    ) -> None:
        self.study, self.config, self.built_for = study, config, config
        self._send, self._run, self._restarts = send, run, restarts
        built = self.built = experiment or study.build(config)
        self.refused = ""
        """why this run, and not the one that was asked for"""
        self._parameters = parameters_of(config, built.parameters)
        self.shared = SharedState()
        self.shared.requests = requests or Requests()
        self.plant = SteeredPlant(built.plant, self.shared, config.seed)
        if self.plant.physics is None:
            raise ConfigError(f"the page can show simulated robots only, not a {type(built.plant).__name__}")
        self._core = built.controller
        self.experiment = replace(
            built,
            plant=self.plant,
            source=steered(built.source, self.shared),
            controller=SteeredController(built.controller, self.shared),
        )
        self.recorder = SwitchedRecorder(run_info(study, config, built), built.channels)
        self._physics = self.plant.rehearse(self.shared.requests.scene, None) or self.plant.physics
        self.watch = Watch(send, built.robot, self._physics, self.shared, run)
        self.watch.period = built.plant.period
        self.watch.recording = lambda: self.recorder.path
        self._announced = False

    def observe(self, pace: Pace) -> None:
        """Reports to the page how time passes."""
        self.watch.report = pace.report

    def announce(self) -> None:
        """Tells the page what can be shown and changed, after the first tick."""
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
                imperfections=self.shared.requests.imperfections or self.plant.built,
                warnings=self.experiment.warnings,
                restarts=self._restarts,
                refused=self.refused,
                parameters=self._parameters,
            )
        )
        self.watch.refresh(now=True)

    def periods(self, seconds: float) -> Iterator[int]:
        """One item per period until the given time of the task is reached, at whatever speed."""
        tick = 0
        while tick == 0 or self.shared.clock < seconds - 1.5 * self.plant.period:
            yield tick
            tick += 1

    def obey(self, message: Message, pace: Pace) -> None:
        """Carries out a request of the page; a request that is not possible is refused with the reason, and nothing
        changes."""
        try:
            self._obey(message, pace)
        except PliantError as error:
            self._send(Note("refused", str(error)))

    def _obey(self, message: Message, pace: Pace) -> None:
        requests = self.shared.requests
        match message:
            case Flow():
                pace.flow = message
                self.watch.refresh(now=True)
            case StepOnce():
                pace.steps += message.periods
            case Aim():
                self.shared.requests = replace(requests, aim=message)
            case TaskScaling():
                self.shared.requests = replace(requests, scaling=message)
            case Pull():
                self.experiment.robot.frame_id(message.frame)
                self.shared.requests = replace(requests, pull=message, pulled_at=time.monotonic())
            case PushNow():
                self.experiment.robot.frame_id(message.frame)
                self.shared.pushes.append((message.frame, message.force, message.duration))
            case Parameters():
                self.retune(message.config)
            case Surroundings():
                self._surround(message)
            case NewImperfections():
                self.plant.rehearse(None, message.config)
                self.shared.requests = replace(requests, imperfections=message.config)
            case Record():
                self._record(message)
            case _:
                pass

    def retune(self, config: CaseConfig) -> None:
        """Gives the controller the parameters of another configuration. Raises PliantError if it cannot have them."""
        before, after = self._parameters, parameters_of(config, self.built.parameters)
        if before is None or after is None:
            change = retuning_of_case(config)
        else:
            change = retuning(before, after, config, self.built.model or self.built.robot, self.plant.period)
        if change.controller is not None and change.controller.needs != core_of(self._core).needs:
            raise ConfigError(
                "these parameters need other signals or another horizon than the run was built for: write them into the"
                " task or case and start it again"
            )
        self._parameters = after
        successor = None if change.controller is None else with_core(self._core, change.controller)
        requests = self.shared.requests
        self.shared.requests = replace(
            requests,
            tunings=change.tunings,
            whole=change.whole,
            controller=successor or requests.controller,
        )
        self.config = config

    def _surround(self, message: Surroundings) -> None:
        physics = self.plant.rehearse(message.scene, None)
        if physics is None:
            return
        self.shared.requests = replace(self.shared.requests, scene=message.scene)
        self._physics = physics
        self.watch.show(physics)
        self._send(SceneChanged(looks_of(physics.model, self.experiment.robot.n), message.scene))

    def _record(self, message: Record) -> None:
        if message.path is None:
            self.finish_recording()
        else:
            scene = DrawnScene(self._physics.model, self.experiment.robot.n) if self.config.log_scene else None
            self.recorder.start(message.path, run_info(self.study, self.config, self.experiment), scene)
        self.watch.refresh(now=True)

    def finish_recording(self, failure: str | None = None) -> None:
        """Ends the log that is being written, if there is one."""
        try:
            path = self.recorder.stop(failure)
        except PliantError as error:
            self._send(Note("failed", str(error)))
            return
        if path is not None:
            self._send(Note("recorded", str(path)))
