"""What the controller wants: cost terms with weight and activation, and how they change from phase to phase.

The cost of a horizon is J = Σ_k dt · ½ Σ_i w_i a_i² r_i² + its value at the last node ([FFMPC] eq. 25–29): `weight` is
w, `activation` is a, which is squared.
"""

from __future__ import annotations

import numpy as np
from pydantic import Field, field_validator

from pliant.entries import ControllerConfig
from pliant.errors import ConfigError
from pliant.spatial import Array


class Term(ControllerConfig):
    """One quadratic cost term."""

    weight: float = Field(
        default=0.0,
        ge=0.0,
        description="scalar weight w of the running nodes",
        json_schema_extra={"unit": "1/(unit of the term)²"},
    )
    activation: tuple[float, ...] = Field(
        default=(1.0,),
        min_length=1,
        description="a per component, squared; the last one counts for all that follow",
    )
    terminal: float | None = Field(
        default=None,
        ge=0.0,
        description="w of the last node; None: as the running ones",
        json_schema_extra={"unit": "1/(unit of the term)²"},
    )
    terminal_times_dt: bool = Field(default=True, description="whether the last node's weight is multiplied by dt too")
    per_node: float | None = Field(
        default=None,
        gt=0.0,
        description="the weight grows along the horizon: node k has min(per_node · k, weight)",
        json_schema_extra={"unit": "1/(unit of the term)²"},
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
            per_joint: the components are joints: a list made for a longer arm counts as far as there are joints.

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
    """The cost terms that count in every phase unless the phase has its own; the unit is that of the weight."""

    posture: Term = Field(
        default=Term(), description="joint positions about the posture reference", json_schema_extra={"unit": "1/rad²"}
    )
    joint_velocity: Term = Field(
        default=Term(), description="joint velocities about zero", json_schema_extra={"unit": "s²/rad²"}
    )
    torque: Term = Field(
        default=Term(),
        description="torque about g(q) − Jᵀλ; in torque feedback the state τ",
        json_schema_extra={"unit": "1/(N·m)²"},
    )
    unfiltered_torque: Term = Field(
        default=Term(), description="w about g(q) − Jᵀλ, torque feedback only", json_schema_extra={"unit": "1/(N·m)²"}
    )
    translation: Term = Field(
        default=Term(), description="tool position, world axes", json_schema_extra={"unit": "1/m²"}
    )
    rotation: Term = Field(
        default=Term(), description="tool orientation log(R_refᵀ R)", json_schema_extra={"unit": "1/rad²"}
    )
    velocity: Term = Field(
        default=Term(), description="tool twist, world axes", json_schema_extra={"unit": "s²/m², s²/rad²"}
    )
    force: Term = Field(default=Term(), description="contact force, contact axes", json_schema_extra={"unit": "1/N²"})
    force_rate: Term = Field(
        default=Term(),
        description="rate of the contact force, force feedback only",
        json_schema_extra={"unit": "s²/N²"},
    )


class PhaseCosts(ControllerConfig):
    """What is different in one phase of a task. Terms that are None are the common ones."""

    contact: bool = Field(default=False, description="whether the model is in contact")
    posture: Term | None = Field(
        default=None,
        description="joint positions about the posture reference; none: the common one",
        json_schema_extra={"unit": "1/rad²"},
    )
    joint_velocity: Term | None = Field(
        default=None,
        description="joint velocities about zero; none: the common one",
        json_schema_extra={"unit": "s²/rad²"},
    )
    torque: Term | None = Field(
        default=None,
        description="torque about g(q) − Jᵀλ; in torque feedback the state τ; none: the common one",
        json_schema_extra={"unit": "1/(N·m)²"},
    )
    unfiltered_torque: Term | None = Field(
        default=None,
        description="w about g(q) − Jᵀλ, torque feedback only; none: the common one",
        json_schema_extra={"unit": "1/(N·m)²"},
    )
    translation: Term | None = Field(
        default=None, description="tool position, world axes; none: the common one", json_schema_extra={"unit": "1/m²"}
    )
    rotation: Term | None = Field(
        default=None,
        description="tool orientation log(R_refᵀ R); none: the common one",
        json_schema_extra={"unit": "1/rad²"},
    )
    velocity: Term | None = Field(
        default=None,
        description="tool twist, world axes; none: the common one",
        json_schema_extra={"unit": "s²/m², s²/rad²"},
    )
    force: Term | None = Field(
        default=None,
        description="contact force, contact axes; none: the common one",
        json_schema_extra={"unit": "1/N²"},
    )
    force_rate: Term | None = Field(
        default=None,
        description="rate of the contact force, force feedback only; none: the common one",
        json_schema_extra={"unit": "s²/N²"},
    )

    def over(self, common: Costs) -> Costs:
        """The costs of this phase."""
        own = {name: term for name in Costs.model_fields if (term := getattr(self, name)) is not None}
        return common.model_copy(update=own)
