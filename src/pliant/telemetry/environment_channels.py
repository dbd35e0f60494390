"""What a contact is believed to feel like, as channels of a log."""

from __future__ import annotations

from pliant.signals import Tick
from pliant.telemetry.channels import Channel, ChannelGroup

_UNITS = {"stiffness": "N/m", "damping": "N·s/m", "stiffness_std": "N/m", "damping_std": "N·s/m"}


def environment_channels(frame: str) -> ChannelGroup:
    """`estimate/FRAME/stiffness`, `…/damping` and their uncertainties, of `Estimate.environments`."""

    def values(tick: Tick) -> tuple[float, ...]:
        felt = tick.estimate.environments[frame]
        return felt.stiffness, felt.damping, felt.stiffness_std, felt.damping_std

    return ChannelGroup(values, tuple(Channel(f"estimate/{frame}/{name}", unit) for name, unit in _UNITS.items()))
