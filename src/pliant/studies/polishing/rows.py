"""What the rows of the polishing cases are made of: controllers, delays, draws, figures."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from pliant.configuration import merged
from pliant.experiments.case import Changes, Draws, Row
from pliant.simulation import Imperfections
from pliant.studies.figures import Drawn, against_value, in_rows
from pliant.studies.polishing.config import PolishingConfig

STOCK = ("classical-mpc", "torque-feedback-mpc", "force-feedback-mpc")
"""the three controllers that the paper compares, in its order"""
BEST = "offset-free-mpc"
"""pliant's own; it is judged"""
ALL = (*STOCK, BEST)
TILTS = (-6.0, -4.0, -2.0, 0.0, 2.0, 4.0, 6.0)
"""degrees, of the tables"""
FEW_TILTS = (-6.0, -2.0, 2.0, 6.0)
"""degrees, of ablations and sweeps"""
DELAY = 5e-3  # s, the paper's δ_o
WITHOUT_LOOP: Changes = {"imperfections": {"torque_loop": {"gain_p": 0.0, "gain_i": 0.0, "gain_d": 0.0}}}
"""the drives without their torque loop"""
DRAWN = (
    Drawn("E_λ", "force error E_λ, N", "force"),
    Drawn("E_P", "position error E_P, mm", "position"),
)
ROWS = in_rows(DRAWN, "polishing")


def case_config(name: str, **changes: Any) -> PolishingConfig:
    """A case of the study."""
    return merged(PolishingConfig(case=name), changes)


def imperfect(pid: bool = True, delay: float = 0.0) -> dict[str, Any]:
    """Changes for the robot of the paper's simulation. Args: pid: with the drives' torque loop; delay: δ_o, s."""
    return {"imperfections": Imperfections.p3(pid=pid, computation_delay=delay).model_dump()}


def delayed(controller: str) -> Changes:
    """The paper's δ_o for the controller that is made for it, none for the others: they stop with it."""
    return {"imperfections": {"computation_delay": DELAY if controller == BEST else 0.0}}


def tilted(tilts: Sequence[float], usual: int) -> Draws:
    """Every tilt with other draws each; the first draw is the case's seed on the last tilt."""

    def draws(base: Any, seeds: int | None) -> Sequence[Changes]:
        count = seeds or usual
        return [
            {"table": {"tilt": math.radians(tilt)}, "seed": base.seed + place * count + seed}
            for place, tilt in enumerate(reversed(tilts))
            for seed in range(count)
        ]

    return draws


SWEPT = tilted(FEW_TILTS, 3)
"""draws of ablations and sweeps"""


def varied(
    controller: str,
    label: str,
    changes: Changes,
    value: float | None = None,
    targets: Mapping[str, float] | None = None,
) -> Row:
    """A row of a sweep, with the delay that the controller bears."""
    both = {**delayed(controller), **changes}
    if "imperfections" in changes:
        both["imperfections"] = {**delayed(controller)["imperfections"], **changes["imperfections"]}
    return Row(label, controller, both, value, targets=targets or {})


def against(label: str, log_x: bool = False) -> Any:
    """The figure of a parameter. Args: label: of its axis."""
    return against_value(DRAWN, label, "polishing", log_x)
