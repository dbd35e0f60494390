"""Values that are drawn at random, once a seed."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from pydantic import Field

from pliant.configuration import Config
from pliant.quantity import Range


class Uniform(Config):
    """Anything between two values."""

    uniform: Range = Field(description="lowest and highest value")


class Normal(Config):
    """Normally distributed."""

    normal: tuple[float, Annotated[float, Field(ge=0.0)]] = Field(description="mean and standard deviation")


class OneOf(Config):
    """One of several values, each as likely."""

    choice: tuple[float, ...] = Field(min_length=1, description="the values")


Drawn = float | Uniform | Normal | OneOf
"""a number, or how it is drawn"""


def drawn(value: Drawn, rng: np.random.Generator) -> float:
    """The number, or one draw of it."""
    if isinstance(value, Uniform):
        return float(rng.uniform(*value.uniform))
    if isinstance(value, Normal):
        return float(rng.normal(*value.normal))
    if isinstance(value, OneOf):
        return float(rng.choice(value.choice))
    return float(value)


def bounds(value: Drawn) -> tuple[float, float]:
    """Lowest and highest value that can come out; of a normal one ± 3 standard deviations."""
    if isinstance(value, Uniform):
        return value.uniform
    if isinstance(value, Normal):
        return value.normal[0] - 3.0 * value.normal[1], value.normal[0] + 3.0 * value.normal[1]
    if isinstance(value, OneOf):
        return min(value.choice), max(value.choice)
    return value, value
