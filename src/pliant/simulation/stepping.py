"""How a control period is cut into physics steps."""

from __future__ import annotations

import numpy as np

from pliant.errors import ConfigError


def substeps(period: float, physics_step: float) -> int:
    """Physics steps in a control period, both in s. Raises ConfigError if it is not a whole number of them."""
    if not (physics_step > 0.0 and period > 0.0):
        raise ConfigError(f"period and physics step must be above zero, got {period} s and {physics_step} s")
    ratio = period / physics_step
    if abs(ratio - round(ratio)) > 1e-6 or round(ratio) < 1:
        raise ConfigError(
            f"the control period must be a whole multiple of the physics step, got {period:g} s and {physics_step:g} s"
        )
    return round(ratio)


def shares(total: int, parts: int) -> list[int]:
    """A whole number in about equal parts, none of them zero."""
    return [len(part) for part in np.array_split(np.arange(total), min(parts, total))]
