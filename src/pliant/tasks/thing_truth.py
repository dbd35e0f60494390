"""How a thing of a scene differs from what the controller believes of it."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from pliant.configuration import Config
from pliant.quantity import quantity
from pliant.tasks.draws import Drawn

_Shift = tuple[Drawn, Drawn, Drawn]


class ThingTruth(Config):
    """Where a thing really stands, and how it feels; each value may be drawn, once a seed."""

    shift: _Shift = quantity((0.0, 0.0, 0.0), "m", "of its place, along its own x, y and z axes")
    tilt: Drawn = quantity(0.0, "deg", "about `axis`, through its place")
    axis: Literal["random"] | tuple[float, float, float] = Field(
        default="random", description="of the tilt: a direction in its own axes, or a random one across its z axis"
    )
    stiffness: Drawn | None = quantity(None, "N/m", "none: as believed")
    damping: Drawn | None = quantity(None, "N·s/m", "none: as believed")
    friction: Drawn | None = quantity(None, "1", "none: as believed")
    mass: Drawn | None = quantity(None, "kg", "of a box or ball that can move; none: as believed")
