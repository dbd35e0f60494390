"""Timed lists of phases as text, and what their source says tick by tick."""

from __future__ import annotations

from typing import Any

import numpy as np

from pliant.signals import Estimate, Reference
from pliant.studies.task.build_list import listed
from pliant.studies.task.config import TaskCase
from pliant.studies.task.timed import timed_source

FILE = "tables-2-3-4"
TIMED = """
robot = "iiwa14"
controller = "force-feedback-mpc"
timed = true
locked = { A7 = 0.0 }
start = { xyz = [0.6, 0.0, 0.15], rpy = [180, 0, 180] }
"""
DOWN = '[[phase]]\nname = "down"\ntarget = [0.6, 0.0, 0.1]\nduration = 0.5\n'
PRESS = '[[phase]]\nname = "press"\nframe = "contact"\nwrench = [0, 0, 10]\nduration = 1.0\n'


def said(case: TaskCase, seconds: float, off: float = 0.0, touching: bool = False) -> list[Reference]:
    """References every 10 ms of a robot that stands still. Args: off: m, by which its first joint is beside its start;
    touching: whether contact is felt."""
    made = listed(case)
    source, nothing = timed_source(case, made.robot, made.start, None), np.zeros(made.robot.n)
    q = made.start + off * np.eye(made.robot.n)[0]
    found: list[Reference] = []
    state: Any = None
    for time in np.arange(0.0, seconds, 0.01).tolist():
        estimate = Estimate(time, q, nothing, nothing, nothing, contacts={"tool": touching})
        state = source.init(estimate) if state is None else state
        reference, state = source.step(estimate, state)
        found.append(reference)
    return found


def places(references: list[Reference]) -> np.ndarray:
    return np.array([one.tasks[0].position for one in references])
