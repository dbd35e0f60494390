"""Haptic exploration: moves the targets of another source so that contact forces become the desired ones."""

from __future__ import annotations

import math
from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np

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
    """An explored frame, the names of its channels, when it was last there, and how far it went along its axes."""

    __slots__ = ("explored", "names", "place", "said", "task", "time", "way")

    def __init__(self, frame: str, time: float, place: Array) -> None:
        self.explored, self.time, self.place, self.way = ExploredFrame(), time, place, np.zeros(3)
        self.names = tuple(f"exploration/{frame}/{name}" for name in CHANNELS)
        self.task: TaskReference | None = None
        """the last one"""
        self.said: _Said | None = None
        """of that task; a target at rest is the same from tick to tick"""


class _Said(NamedTuple):
    """What a task asks for, as plain numbers."""

    wrench: list[float]
    """(6,) N and N·m"""
    place: list[float]
    """(3,) m"""
    velocity: list[float]
    """(6,) m/s and rad/s"""
    pressed: bool
    """whether the wrench is not zero"""


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
        period = estimate.time - state.time
        if period < 0.0:
            raise SignalError(f"time runs backwards: {estimate.time:g} s after {state.time:g} s")
        state.time = estimate.time
        if isinstance(plain.tuning, ExplorationConfig) and plain.tuning is not state.rules.config:
            state.rules = FrameRules(plain.tuning)
        diagnostics: dict[str, float | Array] = dict(plain.diagnostics)
        period = min(period, _LONGEST_PERIOD)
        tasks = tuple([self._felt(task, estimate, state, period, diagnostics) for task in plain.tasks])
        return changed(plain, tasks=tasks, diagnostics=diagnostics), state

    def _felt(
        self,
        task: TaskReference,
        estimate: Estimate,
        state: ExplorationState,
        period: float,
        diagnostics: dict[str, float | Array],
    ) -> TaskReference:
        """The task with its target shifted."""
        tuning = task.tuning or self.tunings.get(task.frame)
        modes = task.modes if state.rules.config.direction == "axes" else None
        frame = state.frames.get(task.frame)
        said = frame.said if frame is not None and frame.task is task else None
        said = said or _numbers(task)
        desired, place, velocity, pressed = said
        asked = pressed or (modes is not None and "force" in modes.modes)
        if frame is None or estimate.time - frame.time > _FORGOTTEN:
            if not asked:
                return task  # no desired force, and no offset so far
            frame = state.frames[task.frame] = _Frame(task.frame, estimate.time, task.position)
        frame.time, frame.task, frame.said = estimate.time, task, said
        if tuning is None:
            raise ConfigError(
                f"frame {task.frame!r} needs its impedance (stiffness, force_max, range) to be explored: give the task"
                f" a tuning, or HapticExploration one for the frame; {options(self.tunings, task.frame)}"
            )
        measured = _usable(estimate, task, asked)
        explored = frame.explored
        told, rotation = (desired, measured, place, velocity), None
        if state.rules.config.direction == "axes":
            rotation = task.task_rotation if modes is None else modes.rotation if modes.turned else None
        if rotation is not None:
            told = _in_axes(rotation, modes, task, measured, frame)
        explored.step(state.rules, tuning, *told, estimate.time, period, modes, rotation)
        _report(frame, diagnostics)
        return _shifted(task, explored, tuning, desired, place)


def _numbers(task: TaskReference) -> _Said:
    desired: list[float] = task.wrench.tolist()
    place: list[float] = task.position.tolist()
    if not math.isfinite(sum(desired) + sum(place)):
        raise SignalError(f"the reference of frame {task.frame!r} is not finite: {place} m, {desired} N and N·m")
    return _Said(desired, place, task.velocity.tolist(), any(desired))


def _in_axes(
    R: Array, modes: AxisModes | None, task: TaskReference, measured: list[float] | None, frame: _Frame
) -> tuple[list[float], list[float] | None, list[float], list[float]]:
    """Desired and measured wrench, place and velocity in axes R_world_axes (3, 3).

    Where the axes may turn, which they do without modes, the place is the way along them: a turn alone is no motion.
    """
    desired, velocity = in_world(R.T, task.wrench.tolist()), in_world(R.T, task.velocity.tolist())
    felt = None if measured is None else in_world(R.T, measured)
    if modes is not None:
        asked = zip(desired, modes.having("force"), strict=True)
        return [part if force else 0.0 for part, force in asked], felt, (R.T @ task.position).tolist(), velocity
    frame.way, frame.place = frame.way + R.T @ (task.position - frame.place), task.position
    small = _ROUNDING * max(map(abs, desired))
    return [part if abs(part) > small else 0.0 for part in desired], felt, frame.way.tolist(), velocity


def _usable(estimate: Estimate, task: TaskReference, needed: bool) -> list[float] | None:
    """The measured wrench (6,); None if it is not finite, or missing and not needed."""
    wrench = estimate.wrenches.get(task.frame)
    if wrench is None:
        if needed:
            raise SignalError(
                f"frame {task.frame!r} has the desired wrench {task.wrench.tolist()} but no force signal;"
                f" {options(estimate.wrenches, task.frame)}"
            )
        return [0.0] * 6
    values: list[float] = wrench.tolist()
    return values if math.isfinite(sum(values)) else None


def _report(frame: _Frame, diagnostics: dict[str, float | Array]) -> None:
    explored = frame.explored
    count = len(explored.limits)
    axes = explored.axes[:count]
    names = frame.names
    values = [
        *explored.offsets[:count],
        *[axis.phase for axis in axes],
        *[axis.stiffness for axis in axes],
        *[axis.reachable for axis in axes],
        *[axis.unreachable for axis in axes],
        *[axis.clamped for axis in axes],
    ]
    table = np.array(values, dtype=np.float64)
    for at, name in enumerate(names):
        diagnostics[name] = table[at * count : at * count + count]


def _shifted(
    task: TaskReference, explored: ExploredFrame, tuning: ImpedanceTuning, desired: list[float], place: list[float]
) -> TaskReference:
    offsets = in_world(explored.rotation, explored.offsets)
    position = np.array((place[0] + offsets[0], place[1] + offsets[1], place[2] + offsets[2]))
    rotation = task.rotation
    if rotation is not None and (offsets[3] or offsets[4] or offsets[5]):
        rotation = exp3(offsets[3:]) @ rotation
    wrench = task.wrench
    clamped = in_world(explored.rotation, [axis.clamped for axis in explored.axes])
    if any(clamped):
        wrench = np.array([f - c for f, c in zip(desired, clamped, strict=True)])
    return changed(task, position=position, rotation=rotation, wrench=wrench, tuning=tuning)
