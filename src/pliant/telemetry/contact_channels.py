"""Estimated properties of contacts as channels of a log: stiffness and damping, pose of the touched surface."""

from __future__ import annotations

from collections.abc import Sequence

from pliant.signals import Estimate, Tick
from pliant.spatial import Array
from pliant.telemetry.channels import Channel, ChannelGroup

_UNITS = {"stiffness": "N/m", "damping": "N·s/m", "stiffness_std": "N/m", "damping_std": "N·s/m"}
_SURFACE = {"pivot": "m", "turn": "rad", "normal": "1"}
_AXES = ("x", "y", "z")


def contact_groups(estimate: Estimate) -> tuple[list[ChannelGroup], list[ChannelGroup]]:
    """The groups of arrays and the groups of scalars of an estimate like this one."""
    surfaces = [_surface_channels(frame) for frame in estimate.surfaces]
    scalars = [_environment_channels(frame) for frame in estimate.environments]
    return [arrays for arrays, _ in surfaces], scalars + [std for _, std in surfaces]


def _environment_channels(frame: str) -> ChannelGroup:
    """`estimate/FRAME/stiffness`, `…/damping` and their standard uncertainties, from `Estimate.environments`."""

    def values(tick: Tick) -> Sequence[float]:
        found = tick.estimate.environments[frame]
        return found.stiffness, found.damping, found.stiffness_std, found.damping_std

    return ChannelGroup(values, tuple(Channel(f"estimate/{frame}/{name}", unit) for name, unit in _UNITS.items()))


def _surface_channels(frame: str) -> tuple[ChannelGroup, ChannelGroup]:
    """`estimate/FRAME/surface/pivot`, `…/turn` and `…/normal`, each (3,), and `…/normal_std`, from `Estimate.surfaces`.

    Returns:
        The group of arrays and the group of scalars.
    """

    def arrays(tick: Tick) -> Sequence[Array]:
        found = tick.estimate.surfaces[frame]
        return found.pivot, found.turn, found.normal

    def scalars(tick: Tick) -> Sequence[float]:
        return (tick.estimate.surfaces[frame].normal_std,)

    named = tuple(Channel(f"estimate/{frame}/surface/{name}", unit, (3,), _AXES) for name, unit in _SURFACE.items())
    return ChannelGroup(arrays, named), ChannelGroup(scalars, (Channel(f"estimate/{frame}/surface/normal_std", "rad"),))
