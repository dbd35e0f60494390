"""Types of the fields that configurations of the haptic study share."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

_Number = Annotated[float, Field(ge=-1e6, le=1e6)]
Vector = tuple[_Number, _Number, _Number]
NotNegative = Annotated[float, Field(ge=0.0, le=1e8)]
Triple = tuple[NotNegative, NotNegative, NotNegative]
