"""What the seed decides: changes made online, and scenes nobody chose."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from pliant.experiments.drawn_events import changes_drawn
from pliant.studies.haptic.config import HapticCaseConfig
from pliant.studies.haptic.from_task import scene_of_task
from pliant.studies.haptic.scene_config import Hardware
from pliant.studies.haptic.steps_config import OnlineChanges, Step
from pliant.studies.task.config import case_of
from pliant.studies.task.drawn_case import as_drawn
from pliant.tasks import load_task


def drawn(config: HapticCaseConfig) -> HapticCaseConfig:
    """The configuration with every random choice made. The same seed gives the same one."""
    update: dict[str, Any] = {}
    if config.random:
        update |= _scene(config)
    if config.online is not None:
        update |= {"steps": (*config.steps, *_changes(config.online, config.seed)), "online": None}
    return config.model_copy(update=update) if update else config


def _scene(config: HapticCaseConfig) -> dict[str, Any]:
    """Floor, masses and force as the task `random` of the catalogue draws them."""
    task = as_drawn(case_of(load_task("random"), "random").model_copy(update={"seed": config.seed}))
    first = config.steps[0].model_copy(update={"force": task.phase[0].wrench})
    hardware: Hardware = config.hardware.model_copy(update={"mass_scale": task.mass_scale})
    steps = (first, *config.steps[1:])
    return {"environment": scene_of_task(task), "hardware": hardware, "steps": steps, "random": False}


def _changes(online: OnlineChanges, seed: int) -> tuple[Step, ...]:
    """Any of six values changes at a time, whatever the others are, as the task `online` of the catalogue says."""
    changes, quiet = load_task("online").event
    timed = {"time": online.begin, "every": 1.0 / online.rate, "count": online.count}
    drawn_ones = changes_drawn(1, changes.model_copy(update=timed), seed, math.inf)
    steps = [_step(time, name, change) for time, change in drawn_ones for name in change]
    return (*steps, _step(steps[-1].time + 1.0 / online.rate, "quiet", quiet.change))


def _step(time: float, name: str, change: Mapping[str, Any]) -> Step:
    """A change as a step of the study, where a wrench is a force."""
    words = {"wrench": "force"}
    values = {words.get(key, key): value for key, value in change.items()}
    return Step.model_validate({"time": time, "name": words.get(name, name), **values})
