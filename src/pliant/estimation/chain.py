"""A chain of estimators that is compiled: one call per measurement."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from pliant._estimation import Chain, Stage
from pliant.environment import Environment
from pliant.errors import PliantError, SignalError
from pliant.frozen import changed
from pliant.interfaces import Estimator
from pliant.robot import Robot
from pliant.signals import Estimate, Measurement
from pliant.spatial import Array


@dataclass(frozen=True, slots=True)
class ChainState:
    """What a chain remembers."""

    completed: Any
    """state of the estimator whose estimates it completes; None where it begins with the measurement"""
    frames: tuple[str, ...]
    """names of the wrenches that go in"""
    memory: Array
    """numbers of its stages"""


class ChainedEstimator(Estimator[ChainState]):
    """An estimator that is the last stage of a compiled chain (`cpp/estimation`); a subclass makes its stage.

    Where the estimator inside is a chain, too, both are one chain. Where it is somebody else's, that is stepped in
    Python and its estimates are completed. A state can be copied and pickled; a step leaves the state that it gets as
    it is. The stages in Python, as the tests compare them: `tests/twins/estimator_chain`.

    Args:
        stage: what this estimator adds.
        inner: the estimator inside; None: the stage begins with the measurement.
        writes: fields of an estimate that the stage writes.
        named: the robot in which the stage looks up the frames of wrenches; None: it does not.
        environment: frame whose environment the stage finds.
    """

    def __init__(
        self,
        stage: Stage,
        inner: Estimator[Any] | None,
        writes: frozenset[str],
        named: Robot | None = None,
        environment: str | None = None,
    ) -> None:
        self.inner = inner
        joined = isinstance(inner, ChainedEstimator) and not (environment and inner.environment)
        chain = inner if joined and isinstance(inner, ChainedEstimator) else None
        self._stages: tuple[Stage, ...] = (*(chain._stages if chain else ()), stage)
        self._completed: Estimator[Any] | None = chain._completed if chain else inner
        self._writes: frozenset[str] = writes | (chain._writes if chain else frozenset())
        self._robots: tuple[Robot, ...] = (*(chain._robots if chain else ()), *((named,) if named else ()))
        self._senses: bool = chain._senses if chain else named is not None
        self.environment: str | None = environment or (chain.environment if chain else None)
        self._cores: dict[tuple[int, tuple[str, ...]], Chain] = {}

    def init(self, measurement: Measurement) -> ChainState:
        """The state before the first step.

        Raises:
            RobotError: a wrench of a frame that the robot does not have.
            SignalError: sensors shall be tared, and the robot moves.
        """
        given, state = None, None
        frames = tuple(measurement.wrenches) if self._senses else ()
        if self._completed is not None:
            given, _ = self._completed.step(measurement, self._completed.init(measurement))
            state = self._completed.init(measurement)
            frames = tuple(given.wrenches)
        core = self._core(measurement.q.size, frames)
        memory, out = np.zeros(core.memory_size), np.zeros(core.belief_size)
        refusal = core.init(measurement, given, memory, out)
        if refusal is not None:
            raise _refused(refusal)
        return ChainState(state, frames, memory)

    def step(self, measurement: Measurement, state: ChainState) -> tuple[Estimate, ChainState]:
        """The estimate and the next state.

        Raises:
            SignalError: the measurement is older than the last one, or the robot moves while its sensors are tared.
        """
        given = completed = None
        if self._completed is not None:
            given, completed = self._completed.step(measurement, state.completed)
        core = self._core(measurement.q.size, state.frames)
        memory, out = state.memory.copy(), np.empty(core.belief_size)
        refusal = core.step(measurement, given, memory, out)
        if refusal is not None:
            raise _refused(refusal)
        found = self._found(core, measurement, out) if given is None else self._completing(core, given, out)
        return found, ChainState(completed, state.frames, memory)

    # ------------------------------------------------------------------ inside

    def _core(self, n: int, frames: tuple[str, ...]) -> Chain:
        core = self._cores.get((n, frames))
        if core is None:
            for robot in self._robots:
                for frame in frames:
                    robot.frame_id(frame)
            core = self._cores[n, frames] = Chain(self._stages, n, frames, self._completed is not None)
        return core

    def _found(self, core: Chain, measurement: Measurement, out: Array) -> Estimate:
        n, frames = measurement.q.size, core.frames
        wrenches, touches = _wrenches(core, n, out)
        return Estimate(
            measurement.time,
            out[:n],
            out[n : 2 * n],
            out[2 * n : 3 * n],
            measurement.torque_sent,
            dict(zip(frames, wrenches, strict=True)),
            dict(zip(frames, touches, strict=True)),
            out[3 * n : 4 * n] if "disturbance" in self._writes else None,
            {} if self.environment is None else _environments(self.environment, out),
        )

    def _completing(self, core: Chain, given: Estimate, out: Array) -> Estimate:
        """Somebody else's estimate with what this chain writes."""
        n, frames = given.q.size, core.frames
        written = {"q": out[:n], "v": out[n : 2 * n], "torque": out[2 * n : 3 * n], "disturbance": out[3 * n : 4 * n]}
        fields: dict[str, Any] = {name: value for name, value in written.items() if name in self._writes}
        if "wrenches" in self._writes:
            fields["wrenches"] = dict(zip(frames, _wrenches(core, n, out)[0], strict=True))
        if self.environment is not None and (found := _environments(self.environment, out)):
            fields["environments"] = {**given.environments, **found}
        return changed(given, **fields)


def _wrenches(core: Chain, n: int, out: Array) -> tuple[Array, Sequence[bool]]:
    """(frames, 6) and whether each touches."""
    rows, count, start = core.rows, len(core.frames), 4 * n
    touches = out[start + 6 * rows : start + 6 * rows + count].tolist()
    return out[start : start + 6 * count].reshape(count, 6), [touch > 0.0 for touch in touches]


def _environments(frame: str, out: Array) -> dict[str, Environment]:
    stiffness, damping, stiffness_std, damping_std = out[-4:].tolist()
    if stiffness != stiffness:  # nothing is known yet
        return {}
    return {frame: Environment(stiffness, damping, stiffness_std, damping_std)}


def _refused(refusal: tuple[str, float, float]) -> PliantError:
    fault, value, other = refusal
    if fault == "out_of_order":
        return SignalError(f"measurements must arrive in order, got t = {value} s after {other} s")
    return SignalError(
        f"a sensor can be tared only at rest: a joint moves at {value:.2g} rad/s, at most {other:g} rad/s;"
        " start from rest, let the robot hold itself, or tare for a shorter time"
    )
