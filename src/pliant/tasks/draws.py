"""Random values, drawn once per seed."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from pydantic import Field, field_validator

from pliant.configuration import Config
from pliant.quantity import Range, in_order, quantity


class Uniform(Config):
    """Uniformly distributed between two values."""

    uniform: Range = Field(description="lowest and highest value")


class LogUniform(Config):
    """Anything between two values, each factor as likely: as often between 1 and 10 as between 10 and 100."""

    log_uniform: tuple[Annotated[float, Field(gt=0.0)], Annotated[float, Field(gt=0.0)]] = Field(
        description="lowest and highest value, above zero"
    )

    @field_validator("log_uniform")
    @classmethod
    def _in_order(cls, value: tuple[float, float]) -> tuple[float, float]:
        return in_order(value)


class Normal(Config):
    """Normally distributed."""

    normal: tuple[float, Annotated[float, Field(ge=0.0)]] = Field(description="mean and standard deviation")


class OneOf(Config):
    """One of several values with equal probability."""

    choice: tuple[bool, ...] | tuple[float, ...] = Field(min_length=1, description="the values")


Drawn = float | Uniform | LogUniform | Normal | OneOf
"""a number, or how it is drawn"""


class Follows(Config):
    """A value that another drawn one gives: factor times its power."""

    of: str = Field(description="key of the value that it follows, drawn before it")
    factor: float = quantity(1.0, "1", "of the power", gt=-1e12)
    power: float = quantity(1.0, "1", "of the value", ge=-10.0, le=10.0)


class Least(Config):
    """The least of several."""

    least: tuple[Uniform | LogUniform | Normal | OneOf | Follows, ...] = Field(
        min_length=2, description="how each is drawn"
    )


DrawnValue = Uniform | LogUniform | Normal | OneOf | Follows | Least
"""how a value of a task is drawn"""


def drawn(value: Drawn, rng: np.random.Generator) -> float:
    """The number, or one draw of it."""
    if isinstance(value, Uniform):
        return float(rng.uniform(*value.uniform))
    if isinstance(value, LogUniform):
        return float(np.exp(rng.uniform(*np.log(value.log_uniform))))
    if isinstance(value, Normal):
        return float(rng.normal(*value.normal))
    if isinstance(value, OneOf):
        return float(rng.choice(value.choice))
    return float(value)


def bounds(value: Drawn) -> tuple[float, float]:
    """Lowest and highest possible value; of a normal distribution ± 3 standard deviations."""
    if isinstance(value, Uniform):
        return value.uniform
    if isinstance(value, LogUniform):
        return value.log_uniform
    if isinstance(value, Normal):
        return value.normal[0] - 3.0 * value.normal[1], value.normal[0] + 3.0 * value.normal[1]
    if isinstance(value, OneOf):
        return min(value.choice), max(value.choice)
    return value, value
