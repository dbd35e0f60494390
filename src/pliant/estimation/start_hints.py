"""What is odd about the first estimate of a run."""

from __future__ import annotations

import numpy as np

from pliant.signals import Estimate


def start_hints(estimate: Estimate) -> tuple[str, ...]:
    """Sentences about frames that are believed to touch something before anything has moved.

    Where the robot does start in contact they can be ignored; a simulation knows, and says nothing then.

    Args:
        estimate: the first one of a run.
    """
    return tuple(
        f"contact of frame {frame!r} is believed at t = {estimate.time:g} s, with"
        f" {np.linalg.norm(estimate.wrenches[frame][:3]):.2g} N: in free air the sensor carries something that the"
        " estimator does not know; give it a CarriedMass (identify_tool finds mass and centre), or tare at the start"
        " (--set estimation.tare=weight)"
        for frame, touches in estimate.contacts.items()
        if touches and frame in estimate.wrenches
    )
