"""Haptic exploration: moves the targets of another source so that contact forces become the desired ones."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from types import MappingProxyType
from typing import Any

import numpy as np

from pliant._references import pressed as pressed_by
from pliant._values import NamedViews
from pliant.axis_modes import AxisModes
from pliant.errors import ConfigError, SignalError, options
from pliant.frozen import changed
from pliant.interfaces import ReferenceSource
from pliant.references.exploration.config import ExplorationConfig
from pliant.references.exploration.frame import ExploredFrame, FrameRules, in_world
from pliant.signals import Estimate, ImpedanceTuning, Reference, TaskReference
from pliant.spatial import Array, exp3

CHANNELS: Mapping[str, str] = MappingProxyType(
    {
        "offset": "m, rad",
        "phase": "",
        "stiffness": "N/m, N·m/rad",
        "reachable": "N, N·m",
        "unreachable": "",
        "clamped": "N, N·m",
    }
)
"""name of a diagnostics channel below `exploration/FRAME/` → unit; each (k,), k = 3 or 6. Phases are those of
`AxisPhase`."""

_LONGEST_PERIOD = 0.02  # s; after a longer pause the offset continues from where it was
_ROUNDING = 1e-9  # fraction of a wrench; a smaller component along an axis counts as zero
# s; a frame without a task for longer is reset, because its controller did not follow the offset either
_FORGOTTEN = 0.1


class ExplorationState:
    """Owned by the loop: frames, time of the last tick, active parameters."""

    __slots__ = ("frames", "inner", "rules", "time")

    def __init__(self, inner: Any, rules: FrameRules, time: float) -> None:
        self.inner, self.rules, self.time = inner, rules, time
        self.frames: dict[str, _Frame] = {}


class _Frame:
    """An explored frame, its channels, when it was last there, and how far it went along its axes."""

    __slots__ = ("channels", "explored", "place", "pressed", "task", "time", "way")

    def __init__(self, time: float, place: Array) -> None:
        self.explored, self.time, self.place, self.way = ExploredFrame(), time, place, np.zeros(3)
        self.channels = NamedViews((), ())
        self.task: TaskReference | None = None
        """the last one"""
        self.pressed = False
        """whether its wrench is not zero; a target at rest is the same from tick to tick"""


@cache
def _channels(frame: str, count: int) -> NamedViews:
    """Channels of a frame of 3 or 6 axes, of the numbers that its core reports."""
    names = [f"exploration/{frame}/{name}" for name in CHANNELS]
    return NamedViews(names, [(count * place, count) for place in range(len(names))])


class HapticExploration(ReferenceSource[ExplorationState]):
    """Adds an offset Δx to the targets of another source, which regulates the contact force: x_d^h = x_d + Δx, |Δx| ≤
    x_b.

    Per axis, in contact, Δx ← clamp(Δx − T·clamp(k_I (F_d − F)/K̂, ±v_max), ±x_b), where K̂ is the
    stiffness that the contact and the impedance show together. Without a desired force the offset returns to zero. The
    wrench of every task is the desired one; F_d beyond F_max is clamped and the excess reported. Follows [HapFIC] Tiseo
    et al. 2021, sec. II-B, with its Algorithm 1 as mode "paper".

    A reference of the inner source whose `tuning` is an `ExplorationConfig` changes the parameters from that tick on.

    Args:
        inner: where the targets come from.
        config: parameters; the defaults suit a rigid or soft contact at 0.5 to 2 kHz.
        tunings: frame → impedance, for tasks that carry none; the reference passes it on, so that the impedance
            controller sees the same.
    """

    def __init__(
        self,
        inner: ReferenceSource[Any],
        config: ExplorationConfig | None = None,
        tunings: Mapping[str, ImpedanceTuning] | None = None,
    ) -> None:
        self.inner, self.config = inner, config or ExplorationConfig()
        self.tunings = dict(tunings or {})

    def init(self, estimate: Estimate) -> ExplorationState:
        return ExplorationState(self.inner.init(estimate), FrameRules(self.config), estimate.time)

    def step(self, estimate: Estimate, state: ExplorationState) -> tuple[Reference, ExplorationState]:
        """The inner reference with shifted targets.

        Raises:
            SignalError: a frame with a desired force has no force signal, or time runs backwards.
            ConfigError: a task without impedance parameters.
        """
        plain, state.inner = self.inner.step(estimate, state.inner)
        time, period = estimate.time, estimate.time - state.time
        if period < 0.0:
            raise SignalError(f"time runs backwards: {time:g} s after {state.time:g} s")
        state.time = time
        tuning = plain.tuning
        if tuning is not state.rules.config and isinstance(tuning, ExplorationConfig):
            state.rules = FrameRules(tuning)
        diagnostics: dict[str, float | Array] = dict(plain.diagnostics)
        period = min(period, _LONGEST_PERIOD)
        tasks: list[TaskReference] = []
        for task in plain.tasks:
            tasks.append(self._felt(task, estimate, state, period, diagnostics))
        return changed(plain, tasks=tuple(tasks), diagnostics=diagnostics), state

    def _felt(
        self,
        task: TaskReference,
        estimate: Estimate,
        state: ExplorationState,
        period: float,
        diagnostics: dict[str, float | Array],
    ) -> TaskReference:
        """The task with its target shifted."""
        rules, tuning = state.rules, task.tuning or self.tunings.get(task.frame)
        modes = task.modes if rules.axes else None
        frame = state.frames.get(task.frame)
        pressed = frame.pressed if frame is not None and frame.task is task else _pressed(task)
        asked = pressed or (modes is not None and "force" in modes.modes)
        if frame is None or estimate.time - frame.time > _FORGOTTEN:
            if not asked:
                return task  # no desired force, and no offset so far
            frame = state.frames[task.frame] = _Frame(estimate.time, task.position)
        frame.time, frame.task, frame.pressed = estimate.time, task, pressed
        if tuning is None:
            raise ConfigError(
                f"frame {task.frame!r} needs its impedance (stiffness, force_max, range) to be explored: give the task"
                f" a tuning, or HapticExploration one for the frame; {options(self.tunings, task.frame)}"
            )
        felt = estimate.wrenches.get(task.frame)
        if felt is None and asked:
            raise SignalError(
                f"frame {task.frame!r} has the desired wrench {task.wrench.tolist()} but no force signal;"
                f" {options(estimate.wrenches, task.frame)}"
            )
        told, rotation = (task.wrench, felt, task.position, task.velocity), None
        if rules.axes:
            rotation = task.task_rotation if modes is None else modes.rotation if modes.turned else None
        if rotation is not None:
            told = _in_axes(rotation, modes, task, felt, frame)
        explored = frame.explored
        if (
            rules is not explored.rules
            or tuning is not explored.tuning
            or modes is not explored.modes
            or rotation is not explored.rotation
        ):
            explored.prepare(rules, tuning, modes, rotation)
            frame.channels = _channels(task.frame, explored.count)
        numbers, place, turns, clamped = explored.core.step(*told, estimate.time, period)
        frame.channels.into(numbers, diagnostics)
        if rotation is None and not turns and not clamped:
            return changed(task, position=place, tuning=tuning)
        return _shifted(task, explored, tuning, clamped)


def _pressed(task: TaskReference) -> bool:
    found = pressed_by(task.wrench, task.position)
    if found < 0:
        place, desired = task.position.tolist(), task.wrench.tolist()
        raise SignalError(f"the reference of frame {task.frame!r} is not finite: {place} m, {desired} N and N·m")
    return found > 0


def _in_axes(
    R: Array, modes: AxisModes | None, task: TaskReference, measured: Array | None, frame: _Frame
) -> tuple[Array, Array | None, Array, Array]:
    """Desired and measured wrench, place and velocity in axes R_world_axes (3, 3).

    Where the axes may turn, which they do without modes, the place is the way along them: a turn alone is no motion.
    """
    desired, velocity = in_world(R.T, task.wrench.tolist()), np.array(in_world(R.T, task.velocity.tolist()))
    felt = None if measured is None else np.array(in_world(R.T, measured.tolist()))
    if modes is not None:
        asked = zip(desired, modes.having("force"), strict=True)
        return np.array([part if force else 0.0 for part, force in asked]), felt, R.T @ task.position, velocity
    frame.way, frame.place = frame.way + R.T @ (task.position - frame.place), task.position
    small = _ROUNDING * max(map(abs, desired))
    return np.array([part if abs(part) > small else 0.0 for part in desired]), felt, frame.way, velocity


def _shifted(task: TaskReference, explored: ExploredFrame, tuning: ImpedanceTuning, clamped: bool) -> TaskReference:
    offsets, place = explored.offsets, task.position.tolist()
    position = np.array((place[0] + offsets[0], place[1] + offsets[1], place[2] + offsets[2]))
    rotation = task.rotation
    if rotation is not None and (offsets[3] or offsets[4] or offsets[5]):
        rotation = exp3(offsets[3:]) @ rotation
    wrench = task.wrench
    if clamped:
        wrench = np.array([f - c for f, c in zip(wrench.tolist(), explored.clamped, strict=True)])
    return changed(task, position=position, rotation=rotation, wrench=wrench, tuning=tuning)
