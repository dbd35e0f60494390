"""Physics steps of a control period."""

from __future__ import annotations

from pliant.errors import ConfigError
from pliant.sampling import whole_periods

PARTS = 4
"""of a period with explicit contacts, in each of which a force that changes within the period is constant"""


def substeps(period: float, physics_step: float) -> int:
    """Physics steps in a control period, both in s. Raises ConfigError if it is not a whole number of them."""
    if not (physics_step > 0.0 and period > 0.0):
        raise ConfigError(f"period and physics step must be above zero, got {period} s and {physics_step} s")
    count = whole_periods(period, physics_step, "the control period", "the physics step")
    if count < 1:
        raise ConfigError(f"the control period must be at least the physics step, got {period} s and {physics_step} s")
    return count


def shares(total: int, parts: int) -> list[int]:
    """A whole number in about equal parts, none of them zero."""
    parts = min(parts, total)
    size, longer = divmod(total, parts)
    return [size + 1] * longer + [size] * (parts - longer)
