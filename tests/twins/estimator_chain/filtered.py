"""Low-pass filters behind another estimator."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from pliant.frozen import changed
from pliant.interfaces import Estimator
from pliant.signals import Estimate, Measurement
from tests.twins.estimator_chain.filters import LowPassTwin, Memory


@dataclass(frozen=True, slots=True)
class FilteredState:
    """State of the inner estimator and of the filters."""

    inner: Any
    velocity: Memory | None = None
    """None before the first step"""
    torque: Memory | None = None
    wrenches: dict[str, Memory] = field(default_factory=dict)
    """frame → state"""


class FilteredTwin(Estimator[FilteredState]):
    """Low-passes velocities, torques and contact wrenches of another estimator; what has no filter passes
    unchanged."""

    def __init__(
        self,
        inner: Estimator[Any],
        *,
        velocity: LowPassTwin | None = None,
        torque: LowPassTwin | None = None,
        wrench: LowPassTwin | None = None,
    ) -> None:
        self.inner, self.velocity, self.torque, self.wrench = inner, velocity, torque, wrench

    def init(self, measurement: Measurement) -> FilteredState:
        return FilteredState(self.inner.init(measurement))

    def step(self, measurement: Measurement, state: FilteredState) -> tuple[Estimate, FilteredState]:
        raw, inner = self.inner.step(measurement, state.inner)
        v, torque, wrenches = raw.v, raw.torque, raw.wrenches
        memory_v, memory_torque, memories = None, None, dict[str, Memory]()
        if self.velocity is not None:
            v, memory_v = self.velocity.step(v, state.velocity or self.velocity.init(v))
        if self.torque is not None:
            torque, memory_torque = self.torque.step(torque, state.torque or self.torque.init(torque))
        if self.wrench is not None:
            passed = {f: self.wrench.step(w, state.wrenches.get(f) or self.wrench.init(w)) for f, w in wrenches.items()}
            wrenches = {frame: value for frame, (value, _) in passed.items()}
            memories = {frame: memory for frame, (_, memory) in passed.items()}
        estimate = changed(raw, v=v, torque=torque, wrenches=wrenches)
        return estimate, FilteredState(inner, memory_v, memory_torque, memories)
