"""A controller that can be replaced while it runs, for parameters that its references cannot carry."""

from __future__ import annotations

import copy
from dataclasses import dataclass
from typing import Any

from pliant.interfaces import Controller
from pliant.live.loop.requests import SharedState
from pliant.signals import Command, Estimate, Reference


@dataclass(frozen=True, slots=True)
class SteeredControllerState:
    """The active controller and its state."""

    controller: Controller[Any]
    inner: Any
    request: Controller[Any] | None
    """the last replacement that was requested"""


class SteeredController(Controller[SteeredControllerState]):
    """A controller that a request can replace; the replacement starts at the estimate of that period.

    Args:
        inner: the controller at the start.
        shared: the requests, read once a step.
    """

    def __init__(self, inner: Controller[Any], shared: SharedState) -> None:
        self.inner, self._shared = inner, shared

    def init(self, estimate: Estimate) -> SteeredControllerState:
        request = self._shared.requests.controller
        controller = request or self.inner
        return SteeredControllerState(controller, controller.init(estimate), request)

    def step(
        self, estimate: Estimate, reference: Reference, state: SteeredControllerState
    ) -> tuple[Command, SteeredControllerState]:
        request = self._shared.requests.controller
        if request is not state.request and request is not None:
            state = SteeredControllerState(request, request.init(estimate), request)
        command, inner = state.controller.step(estimate, reference, state.inner)
        return command, SteeredControllerState(state.controller, inner, state.request)


def core_of(controller: Controller[Any]) -> Controller[Any]:
    """The controller inside of its wrappers."""
    inner = getattr(controller, "inner", None)
    return core_of(inner) if isinstance(inner, Controller) else controller  # pyright: ignore[reportUnknownArgumentType]


def with_core(controller: Controller[Any], core: Controller[Any]) -> Controller[Any]:
    """The same wrappers (bounds on the torque, say, whose controller is `inner`) round another core."""
    inner = getattr(controller, "inner", None)
    if not isinstance(inner, Controller):
        return core
    wrapper = copy.copy(controller)
    wrapper.inner = with_core(inner, core)  # type: ignore[attr-defined]  # it has one, see above
    return wrapper
