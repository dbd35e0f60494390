"""Hints about an implausible first estimate of a run."""

from __future__ import annotations

import numpy as np

from pliant.signals import Estimate


def start_hints(estimate: Estimate) -> tuple[str, ...]:
    """Sentences about frames that appear to be in contact before anything has moved. If the robot does start in
    contact, they can be ignored; in simulation they are then left out.

    Args:
        estimate: the first one of a run.
    """
    return tuple(
        f"contact of frame {frame!r} is believed at t = {estimate.time:g} s, with"
        f" {np.linalg.norm(estimate.wrenches[frame][:3]):.2g} N: if nothing touches the frame, the sensor carries a"
        " load that the estimator does not know; give it a CarriedMass (identify_tool finds mass and"
        " centre), or tare at the start"
        " (--set estimation.tare=weight)"
        for frame, touches in estimate.contacts.items()
        if touches and frame in estimate.wrenches
    )
