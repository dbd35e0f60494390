"""What the page needs to know of a run before it draws it."""

from __future__ import annotations

from typing import Any

import numpy as np

from pliant.live.link.messages import (
    Ready,
    Samples,
)  # fmt: skip


def task_frames(ready: Ready) -> list[str]:
    find = getattr(ready.config, "frames", None)
    found: Any = find() if callable(find) else ("tool",)
    return [str(frame) for frame in found]


def has_desired_force(samples: Samples, ready: Ready | None) -> bool:
    if ready is None or "desired.x" not in ready.columns or not len(samples.rows):
        return False
    first = ready.columns.index("desired.x")
    return bool(np.nanmax(np.abs(samples.rows[:, first : first + 3]), initial=0.0) > 0.0)
