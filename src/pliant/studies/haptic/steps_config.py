"""Typed configuration of what the user asks for in time: targets, forces, changes."""

from __future__ import annotations

from typing import Self

import numpy as np
from pydantic import Field, model_validator

from pliant.configuration import Config
from pliant.controllers.attractor import Law
from pliant.controllers.profiles import Shape
from pliant.errors import PliantError
from pliant.quantity import quantity
from pliant.signals import ImpedanceTuning
from pliant.studies.haptic.fields import Triple, Vector


class FootImpedance(Config):
    """The fractal impedance at the foot; x, y, z. Defaults: [HapFIC] sec. III."""

    stiffness: Triple = quantity((6000.0, 6000.0, 12000.0), "N/m", "K_0: force per error near the target")
    force_max: Triple = quantity((150.0, 150.0, 300.0), "N", "F_max: bound of the commanded force, not of an impact")
    range: Triple = quantity(
        (0.025, 0.025, 0.025), "m", "x_b: error at which F_max is reached, and bound of the exploration"
    )
    law: Law = Field(default=Law.CAPPED, description="force on the way back to the target")
    profile: Shape = Field(default=Shape.TANH, description="how the force bends towards F_max")

    def tuning(self) -> ImpedanceTuning:
        """The numbers as a value that references carry."""
        return ImpedanceTuning(np.array(self.stiffness), np.array(self.force_max), np.array(self.range))

    @model_validator(mode="after")
    def _is_possible(self) -> Self:
        try:
            self.tuning()
        except PliantError as error:
            raise ValueError(str(error)) from None
        return self


class Step(Config):
    """What the user changes at a time. What is not given stays as it was."""

    time: float = quantity(0.0, "s", "since the start", ge=0.0, le=1e6)
    name: str = Field(default="", description="of the phase that begins, for figures")
    target: Vector | None = quantity(None, "m", "of the foot")
    force: Vector | None = quantity(None, "N", "F_d: desired reaction of the environment on the foot")
    stiffness: Triple | None = quantity(None, "N/m", "K_0")
    force_max: Triple | None = quantity(None, "N", "F_max")
    range: Triple | None = quantity(None, "m", "x_b")
    reset: bool | None = Field(default=None, description="let the offset return when contact is lost")


class OnlineChanges(Config):
    """Random changes of F_d, K_0, F_max, x_b, reset and target, drawn from the seed; some do not fit together."""

    count: int = Field(default=50, ge=1, le=10_000, description="how many")
    rate: float = quantity(4.0, "Hz", "changes per second", ge=1e-3, le=1e3)
    begin: float = quantity(1.0, "s", "of the first one", gt=0.0, le=1e6)
