"""Estimated properties of contacts as channels of a log: stiffness and damping, pose of the touched surface."""

from __future__ import annotations

from pliant.signals import Estimate
from pliant.telemetry.channels import Channel, Key, Path, PlacedChannel

_UNITS = {"stiffness": "N/m", "damping": "N·s/m", "stiffness_std": "N/m", "damping_std": "N·s/m"}
_SURFACE = {"pivot": "m", "turn": "rad", "normal": "1"}
_AXES = ("x", "y", "z")


def contact_channels(estimate: Estimate) -> tuple[list[PlacedChannel], list[PlacedChannel]]:
    """The arrays and the scalars of an estimate like this one.

    `estimate/FRAME/surface/pivot`, `…/turn` and `…/normal`, each (3,), and `…/normal_std`, from `Estimate.surfaces`;
    `estimate/FRAME/stiffness`, `…/damping` and their standard uncertainties, from `Estimate.environments`.
    """
    arrays: list[PlacedChannel] = []
    scalars: list[PlacedChannel] = []
    for frame in estimate.environments:
        path: Path = ("estimate", "environments", Key(frame))
        scalars += [
            PlacedChannel((*path, name), Channel(f"estimate/{frame}/{name}", unit)) for name, unit in _UNITS.items()
        ]
    for frame in estimate.surfaces:
        path = ("estimate", "surfaces", Key(frame))
        named = f"estimate/{frame}/surface"
        arrays += [
            PlacedChannel((*path, name), Channel(f"{named}/{name}", unit, (3,), _AXES))
            for name, unit in _SURFACE.items()
        ]
        scalars.append(PlacedChannel((*path, "normal_std"), Channel(f"{named}/normal_std", "rad")))
    return arrays, scalars
