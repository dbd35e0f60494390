"""A controller that can be replaced while it runs, for parameters that its references cannot carry."""

from __future__ import annotations

import copy
from dataclasses import dataclass
from typing import Any

from pliant.interfaces import Controller
from pliant.live.loop.requests import Desk
from pliant.signals import Command, Estimate, Reference


@dataclass(frozen=True, slots=True)
class SteeredControllerState:
    """Who controls at present, and its state."""

    controller: Controller[Any]
    inner: Any
    wish: Controller[Any] | None
    """the last successor that was asked for"""


class SteeredController(Controller[SteeredControllerState]):
    """Another controller, until the desk names a successor, which starts at the estimate of that period.

    Args:
        inner: who controls at first.
        desk: read once a step.
    """

    def __init__(self, inner: Controller[Any], desk: Desk) -> None:
        self.inner, self._desk = inner, desk

    def init(self, estimate: Estimate) -> SteeredControllerState:
        wish = self._desk.wishes.controller
        controller = wish or self.inner
        return SteeredControllerState(controller, controller.init(estimate), wish)

    def step(
        self, estimate: Estimate, reference: Reference, state: SteeredControllerState
    ) -> tuple[Command, SteeredControllerState]:
        wish = self._desk.wishes.controller
        if wish is not state.wish and wish is not None:
            state = SteeredControllerState(wish, wish.init(estimate), wish)
        command, inner = state.controller.step(estimate, reference, state.inner)
        return command, SteeredControllerState(state.controller, inner, state.wish)


def with_core(controller: Controller[Any], core: Controller[Any]) -> Controller[Any]:
    """The same wrappers (bounds on the torque, say, whose controller is `inner`) round another core."""
    inner = getattr(controller, "inner", None)
    if not isinstance(inner, Controller):
        return core
    wrapper = copy.copy(controller)
    wrapper.inner = with_core(inner, core)  # type: ignore[attr-defined]  # it has one, see above
    return wrapper
