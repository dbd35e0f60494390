"""Lists of phases as text, the case that such a file makes, and the log of its run."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from pliant import loop
from pliant.studies.task.config import TaskCase, case_of
from pliant.tasks import load_task
from pliant.telemetry.log import Log
from pliant.telemetry.recorder import Recorder


def recorded(study: Any, case: Any, period: float) -> Log:
    """The log of a run in memory."""
    wired, recorder = study.build(case), Recorder(None)
    ticks = range(round(case.duration / period))
    loop.run(wired.plant, wired.estimator, wired.source, wired.controller, ticks, [recorder])
    return recorder.log()


PHASES = """
robot = "leg3"
controller = "haptic"
moves = "foot"
compensates = "gravity"
timing = { sensing_delay = 0.0, computation_delay = 0.0 }
simulation = { contact = "explicit", physics_step = 1e-4 }
impedance = { stiffness = [6000, 6000, 12000], force_max = [150, 150, 300], range = 0.025 }
scene.floor = { shape = "plane", stiffness = 1e5, damping = 1e3, friction = 0.0 }
"""
FIRST = '[[phase]]\nname = "down"\ntarget = [0.1, 0.0, 0.017]\nwrench = [0, 0, 20]\n'


def case_from(folder: Path, text: str) -> TaskCase:
    file = folder / "task.toml"
    file.write_text(text, encoding="utf-8")
    return case_of(load_task(file), "task")
