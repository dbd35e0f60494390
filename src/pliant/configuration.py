"""The base of every typed configuration."""

from __future__ import annotations

from pydantic import BaseModel, ConfigDict


class Config(BaseModel):
    """Frozen values with a meaning: unknown keys are errors, defaults are checked too, every number is finite.

    A field says what it means in `description` and its unit, and where it helps a sensible range, in
    `json_schema_extra={"unit": ..., "minimum": ..., "maximum": ...}`: help texts and sliders are made from them.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False, validate_default=True)
