"""Limits of a task."""

from __future__ import annotations

from pydantic import Field, model_validator

from pliant.configuration import Config
from pliant.quantity import quantity
from pliant.tasks.parts import Vector


class WorkspaceConfig(Config):
    """A box in the world, along its axes."""

    lower: Vector = quantity((-100.0, -100.0, -100.0), "m", "least x, y and z")
    upper: Vector = quantity((100.0, 100.0, 100.0), "m", "largest x, y and z")

    @model_validator(mode="after")
    def _holds_something(self) -> WorkspaceConfig:
        if not all(low < high for low, high in zip(self.lower, self.upper, strict=True)):
            raise ValueError(f"lower must be below upper, got {list(self.lower)} and {list(self.upper)}")
        return self


class Limits(Config):
    """Limits of the moved frame: a task that exceeds them is refused, a run that exceeds them ends as failed."""

    force: float | None = quantity(None, "N", "of the contact; none: no limit", gt=0.0)
    speed: float | None = quantity(None, "m/s", "of the frame; none: no limit", gt=0.0)
    torque: float | None = quantity(None, "1", "share of each joint's limit; none: no limit", gt=0.0, le=1.0)
    workspace: WorkspaceConfig | None = Field(default=None, description="where the frame may be; none: anywhere")
