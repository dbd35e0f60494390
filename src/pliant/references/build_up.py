"""A force that is built up from the contact on with which it begins."""

from __future__ import annotations

import math
from typing import NamedTuple

_LEAST_SHARE = 0.02  # none at all would be a request of 0 N


class BuildUp(NamedTuple):
    """How far a force has been built up."""

    press: float = 0.0
    """s that it takes; 0: no force is built up"""
    touched: float = math.inf
    """s of the loop's clock when contact was felt; infinite before"""

    def share(self, time: float) -> float:
        """Of the force: all of it until contact is felt, since some controllers find the surface by it."""
        if time - self.touched >= self.press or math.isinf(self.touched):
            return 1.0
        return max((time - self.touched) / self.press, _LEAST_SHARE)
