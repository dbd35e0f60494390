"""Cost terms with weight and activation, and how they change from phase to phase.

The cost of a horizon is J = Σ_k dt · ½ Σ_i w_i a_i² r_i² + its value at the last node ([FFMPC] eq. 25–29): `weight` is
w, `activation` is a, which is squared.
"""

from __future__ import annotations

import numpy as np
from pydantic import Field, field_validator

from pliant.entries import ControllerConfig
from pliant.errors import ConfigError
from pliant.quantity import quantity
from pliant.spatial import Array


class Term(ControllerConfig):
    """One quadratic cost term."""

    weight: float = quantity(0.0, "1/(unit of the term)²", "scalar weight w of the running nodes", ge=0.0)
    activation: tuple[float, ...] = Field(
        default=(1.0,),
        min_length=1,
        description="a per component, squared; the last one applies to all further components",
    )
    terminal: float | None = quantity(
        None, "1/(unit of the term)²", "w of the last node; None: as the running ones", ge=0.0
    )
    terminal_times_dt: bool = Field(default=True, description="whether the last node's weight is multiplied by dt too")
    per_node: float | None = quantity(
        None,
        "1/(unit of the term)²",
        "the weight grows along the horizon: node k has min(per_node · k, weight)",
        gt=0.0,
    )

    @field_validator("activation")
    @classmethod
    def _not_negative(cls, value: tuple[float, ...]) -> tuple[float, ...]:
        if any(entry < 0.0 for entry in value):
            raise ValueError("an activation must not be negative")
        return value

    def along(self, horizon: int, size: int, dt: float, name: str, *, per_joint: bool = False) -> Array:
        """Weights of the N + 1 nodes, in the units of the solver (running nodes without dt, the last one with it).

        Args:
            horizon: N.
            size: number of components of the residual.
            dt: s.
            name: of the term, for the error.
            per_joint: the components are joints: of a list made for a longer arm, the first entries are used.

        Returns:
            (N+1, size) w a².

        Raises:
            ConfigError: more activations than components.
        """
        if len(self.activation) > size and not per_joint:
            raise ConfigError(f"cost {name!r} has {size} components, got {len(self.activation)} activations")
        given = np.array(self.activation[:size])
        squared = np.square(np.pad(given, (0, size - len(given)), mode="edge"))
        scalar = np.full(horizon + 1, self.weight)
        if self.terminal is not None:
            scalar[-1] = self.terminal
        if self.per_node is not None:
            scalar = np.minimum(self.per_node * np.arange(horizon + 1), scalar)
        if self.terminal_times_dt:
            scalar[-1] *= dt
        return scalar[:, None] * squared[None, :]


class Costs(ControllerConfig):
    """The cost terms of every phase that has no own ones; the unit is that of the weight."""

    posture: Term = quantity(Term(), "1/rad²", "joint positions about the posture reference")
    joint_velocity: Term = quantity(Term(), "s²/rad²", "joint velocities about zero")
    torque: Term = quantity(Term(), "1/(N·m)²", "torque about g(q) − Jᵀλ; in torque feedback the state τ")
    unfiltered_torque: Term = quantity(Term(), "1/(N·m)²", "w about g(q) − Jᵀλ, torque feedback only")
    translation: Term = quantity(Term(), "1/m²", "tool position, world axes")
    rotation: Term = quantity(Term(), "1/rad²", "tool orientation log(R_refᵀ R)")
    velocity: Term = quantity(Term(), "s²/m², s²/rad²", "tool twist, world axes")
    force: Term = quantity(Term(), "1/N²", "contact force, contact axes")
    force_rate: Term = quantity(Term(), "s²/N²", "rate of the contact force, force feedback only")


class PhaseCosts(ControllerConfig):
    """Costs of one phase of a task. Terms that are None are the common ones."""

    contact: bool = Field(default=False, description="whether the model is in contact")
    posture: Term | None = quantity(None, "1/rad²", "joint positions about the posture reference; none: the common one")
    joint_velocity: Term | None = quantity(None, "s²/rad²", "joint velocities about zero; none: the common one")
    torque: Term | None = quantity(
        None, "1/(N·m)²", "torque about g(q) − Jᵀλ; in torque feedback the state τ; none: the common one"
    )
    unfiltered_torque: Term | None = quantity(
        None, "1/(N·m)²", "w about g(q) − Jᵀλ, torque feedback only; none: the common one"
    )
    translation: Term | None = quantity(None, "1/m²", "tool position, world axes; none: the common one")
    rotation: Term | None = quantity(None, "1/rad²", "tool orientation log(R_refᵀ R); none: the common one")
    velocity: Term | None = quantity(None, "s²/m², s²/rad²", "tool twist, world axes; none: the common one")
    force: Term | None = quantity(None, "1/N²", "contact force, contact axes; none: the common one")
    force_rate: Term | None = quantity(
        None, "s²/N²", "rate of the contact force, force feedback only; none: the common one"
    )

    def over(self, common: Costs) -> Costs:
        """The costs of this phase."""
        own = {name: term for name in Costs.model_fields if (term := getattr(self, name)) is not None}
        return common.model_copy(update=own)
