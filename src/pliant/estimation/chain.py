"""A chain of estimators that is compiled: one call per measurement."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from pliant._estimation import Chain, Stage
from pliant._values import Views
from pliant.environment import Environment
from pliant.errors import PliantError, SignalError
from pliant.estimation.compiled_chain import CompiledChain
from pliant.frozen import changed, quick
from pliant.interfaces import Estimator
from pliant.named_rows import NamedRows
from pliant.robot import Robot
from pliant.signals import Estimate, Measurement
from pliant.spatial import Array


@quick
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
        self._observes = "disturbance" in self._writes
        self._senses: bool = chain._senses if chain else named is not None
        self.environment: str | None = environment or (chain.environment if chain else None)
        self._bound: dict[tuple[int, tuple[str, ...]], _Bound] = {}

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
        bound = self._for(measurement.q.size, frames)
        memory, out = np.zeros(bound.core.memory_size), np.zeros(bound.size)
        refusal = bound.core.init(measurement, given, memory, out)
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
        bound = self._for(measurement.q.size, state.frames)
        memory, out = state.memory.copy(), np.empty(bound.size)
        refusal = bound.core.step(measurement, given, memory, out)
        if refusal is not None:
            raise _refused(refusal)
        found = self._found(bound, measurement, out) if given is None else self._completing(bound, given, out)
        return found, ChainState(completed, state.frames, memory)

    def compiled_face(self, measurement: Measurement, state: ChainState, last: Estimate) -> CompiledChain | None:
        if self._completed is not None or any(stage.in_python for stage in self._stages):
            return None
        bound, known = self._for(measurement.q.size, state.frames), bool(last.environments)
        found = partial(self._found, bound)
        frame = self.environment
        return CompiledChain(self._stages, state.frames, bound.size, bound.touches, frame, known, found)

    # ------------------------------------------------------------------ inside

    def _for(self, n: int, frames: tuple[str, ...]) -> _Bound:
        bound = self._bound.get((n, frames))
        if bound is None:
            for robot in self._robots:
                for frame in frames:
                    robot.frame_id(frame)
            bound = _Bound(Chain(self._stages, n, frames, self._completed is not None), n)
            self._bound[n, frames] = bound
        return bound

    def _found(self, bound: _Bound, measurement: Measurement, out: Array) -> Estimate:
        q, v, torque, disturbance = bound.joints(out)
        return Estimate(
            measurement.time,
            q,
            v,
            torque,
            measurement.torque_sent,
            bound.wrenches(out),
            bound.contacts(out),
            disturbance if self._observes else None,
            {} if self.environment is None else _environments(self.environment, out),
        )

    def _completing(self, bound: _Bound, given: Estimate, out: Array) -> Estimate:
        """Somebody else's estimate with what this chain writes."""
        written = dict(zip(("q", "v", "torque", "disturbance"), bound.joints(out), strict=True))
        fields: dict[str, Any] = {name: value for name, value in written.items() if name in self._writes}
        if "wrenches" in self._writes:
            fields["wrenches"] = bound.wrenches(out)
        if self.environment is not None and (found := _environments(self.environment, out)):
            fields["environments"] = {**given.environments, **found}
        return changed(given, **fields)


class _Bound:
    """A chain for one robot and its sensors, and where its estimates lie in a row of numbers."""

    def __init__(self, core: Chain, n: int) -> None:
        self.core, self.size = core, core.belief_size
        self.joints = Views([(i * n, n) for i in range(4)]).of
        """row → views of position, velocity, torque and disturbance of the joints, (n,) each"""
        self.wrenches = NamedRows(core.frames, 4 * n, 6).of
        """row → frame → wrench (6,)"""
        self.touches = {frame: at for at, frame in enumerate(core.frames, start=4 * n + 6 * core.rows)}
        """frame → which number of a row says whether it touches"""

    def contacts(self, out: Array) -> dict[str, bool]:
        """Frame → whether it touches."""
        return {frame: bool(out.item(at)) for frame, at in self.touches.items()}


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
