"""What changes while the robot moves, once or again and again, as written or drawn."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import Field, model_validator

from pliant.configuration import Config
from pliant.quantity import quantity
from pliant.tasks.draws import Drawn

Scaled = Literal["stiffness", "force_max", "range", "linear_range"]


class Event(Config):
    """Something that the user changes while the robot moves."""

    time: Drawn = quantity(0.0, "s", "since the start of the run; one draw a seed")
    every: float | None = quantity(None, "s", "from one change to the next; none: there is one", gt=0.0, le=3600.0)
    count: int | None = Field(
        default=None, ge=1, le=100_000, description="how many changes, with `every`; none: until the run ends"
    )
    pick: Literal["all", "one"] = Field(
        default="all", description="of what `change` names: all of it, or one of it, each as likely"
    )
    change: dict[str, Any] = Field(
        default={},
        description="target (m), wrench (N), stiffness (N/m), force_max (N), range (m), reset; or controller.NAME.KEY;"
        " each number may be drawn, anew for each change",
    )
    factor: dict[Scaled, Drawn] = Field(
        default={},
        description="stiffness, force_max, range or linear_range of every impedance → factor on what it was at the"
        " start, drawn for each axis; F_max stays at K_0 x_0 or above, x_0 at 0.95 x_b or below",
    )
    file: str | None = Field(
        default=None,
        description="CSV with time, x, y, z: targets that come one after the other, `time` later; beside the task",
    )

    @model_validator(mode="after")
    def _can_be(self) -> Event:
        if self.count is not None and self.every is None:
            raise ValueError("how many changes there are (count) needs the time between them (every)")
        if self.file is not None and (self.change or self.factor or self.every):
            raise ValueError("an event of a file has no change, factor or every: the file says what comes when")
        return self
