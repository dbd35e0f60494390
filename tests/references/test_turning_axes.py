"""Exploration where the axes of the task lean and turn: the target moves along the force that is asked for, alone."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pliant.interfaces import ReferenceSource
from pliant.references.exploration.haptic_exploration import HapticExploration
from pliant.signals import Estimate, ImpedanceTuning, Reference, TaskReference
from pliant.spatial import Array, exp3

FORCE = 20.0  # N
RADIUS, MIDDLE = 0.2, np.array([0.5, 0.0, 0.3])  # m
TUNING = ImpedanceTuning(np.full(3, 2500.0), np.full(3, 100.0), np.full(3, 0.06))


class Played(ReferenceSource[int]):
    """One task after the other."""

    def __init__(self, tasks: Sequence[TaskReference]) -> None:
        self.tasks = tasks

    def init(self, estimate: Estimate) -> int:
        return 0

    def step(self, estimate: Estimate, state: int) -> tuple[Reference, int]:
        return Reference(estimate.time, (self.tasks[state],)), state + 1


def pressed(turns: Sequence[float], told: bool) -> list[TaskReference]:
    """On a sphere at angles from its top, in the sphere's axes if they are told."""
    found: list[TaskReference] = []
    for turn in turns:
        R = exp3(np.array([0.0, turn, 0.0]))
        n = R[:, 2]
        wrench = np.concatenate([FORCE * n, np.zeros(3)])
        found.append(
            TaskReference("tool", MIDDLE + RADIUS * n, wrench=wrench, tuning=TUNING, task_rotation=R if told else None)
        )
    return found


def offsets(tasks: Sequence[TaskReference], felt: Sequence[Array]) -> tuple[Array, Array]:
    """(k, 3) m by which targets are moved, world axes, and (k,) the stiffness that the last axis believes."""
    source, zero = HapticExploration(Played(tasks)), np.zeros(7)
    moved, stiffness, state = [], [], None
    for tick, (task, wrench) in enumerate(zip(tasks, felt, strict=True)):
        estimate = Estimate(1e-3 * tick, zero, zero, zero, zero, wrenches={"tool": wrench})
        state = source.init(estimate) if state is None else state
        reference, state = source.step(estimate, state)
        moved.append(reference.tasks[0].position - task.position)
        stiffness.append(float(np.asarray(reference.diagnostics["exploration/tool/stiffness"])[2]))
    return np.array(moved), np.array(stiffness)


def test_friction_is_not_taken_for_a_force_that_is_missing() -> None:
    """A surface that leans by 0.5 rad, pressed as hard as is asked for, with friction across."""
    slid = exp3(np.array([0.0, 0.5, 0.0]))[:, 0]
    tasks, worlds = (pressed([0.5] * 300, told) for told in (True, False))
    felt = [task.wrench + np.concatenate([0.25 * FORCE * slid, np.zeros(3)]) for task in tasks]
    assert np.abs(offsets(tasks, felt)[0]).max() < 1e-9
    assert np.abs(offsets(worlds, felt)[0]).max() > 0.01  # the control: forces along the world's axes


def test_an_offset_turns_with_the_surface_and_a_turn_is_no_motion() -> None:
    turns = np.concatenate([np.zeros(200), np.linspace(0.0, 0.8, 800)])
    tasks, worlds = (pressed(turns.tolist(), told) for told in (True, False))
    felt = [(0.5 if tick < 200 else 1.0) * task.wrench for tick, task in enumerate(tasks)]
    normals = np.array([task.wrench[:3] / FORCE for task in tasks])
    moved, stiffness = offsets(tasks, felt)
    size = float(moved[200] @ normals[200])
    assert size < -0.001
    np.testing.assert_allclose(moved[200:], size * normals[200:], atol=1e-9)
    assert stiffness[300:].min() > 2500.0 - 1e-9  # a turn about a far place is no way
    stays = offsets(worlds, felt)[0]
    assert np.abs(stays[-1] - size * normals[-1]).max() > 0.3 * abs(size)  # the control: it stays as it was
