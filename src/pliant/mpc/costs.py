"""What the controller wants: cost terms with weight and activation, and how they change from phase to phase.

The cost of a horizon is J = Σ_k dt · ½ Σ_i w_i a_i² r_i² + its value at the last node ([FFMPC] eq. 25–29): `weight` is
w, `activation` is a, which is squared.
"""

from __future__ import annotations

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, field_validator

from pliant.errors import ConfigError
from pliant.spatial import Array


class Described(BaseModel):
    """Base of the descriptions in this folder: frozen, unknown keys are errors, not-a-number is refused."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False, validate_default=True)


class Term(Described):
    """One quadratic cost term."""

    weight: float = Field(default=0.0, ge=0.0, description="scalar weight w of the running nodes")
    activation: tuple[float, ...] = Field(
        default=(1.0,), min_length=1, description="a per component, squared; the last one counts for all that follow"
    )
    terminal: float | None = Field(default=None, ge=0.0, description="w of the last node; None: as the running ones")
    terminal_times_dt: bool = Field(default=True, description="whether the last node's weight is multiplied by dt too")
    per_node: float | None = Field(
        default=None, gt=0.0, description="the weight grows along the horizon: node k has min(per_node · k, weight)"
    )

    @field_validator("activation")
    @classmethod
    def _not_negative(cls, value: tuple[float, ...]) -> tuple[float, ...]:
        if any(entry < 0.0 for entry in value):
            raise ValueError("an activation must not be negative")
        return value

    def along(self, horizon: int, size: int, dt: float, name: str) -> Array:
        """Weights of the N + 1 nodes, in the units of the solver (running nodes without dt, the last one with it).

        Args:
            horizon: N.
            size: number of components of the residual.
            dt: s.
            name: of the term, for the error.

        Returns:
            (N+1, size) w a².

        Raises:
            ConfigError: more activations than components.
        """
        if len(self.activation) > size:
            raise ConfigError(f"cost {name!r} has {size} components, got {len(self.activation)} activations")
        squared = np.square(np.pad(np.array(self.activation), (0, size - len(self.activation)), mode="edge"))
        scalar = np.full(horizon + 1, self.weight)
        if self.terminal is not None:
            scalar[-1] = self.terminal
        if self.per_node is not None:
            scalar = np.minimum(self.per_node * np.arange(horizon + 1), scalar)
        if self.terminal_times_dt:
            scalar[-1] *= dt
        return scalar[:, None] * squared[None, :]


class Costs(Described):
    """The cost terms that count in every phase unless the phase has its own."""

    posture: Term = Field(default=Term(), description="joint positions about the posture reference, 1/rad²")
    joint_velocity: Term = Field(default=Term(), description="joint velocities about zero, s²/rad²")
    torque: Term = Field(
        default=Term(), description="torque about g(q) − Jᵀλ, 1/(N·m)²; in torque feedback the state τ"
    )
    unfiltered_torque: Term = Field(default=Term(), description="w about g(q) − Jᵀλ, torque feedback only, 1/(N·m)²")
    translation: Term = Field(default=Term(), description="tool position, world axes, 1/m²")
    rotation: Term = Field(default=Term(), description="tool orientation log(R_refᵀ R), 1/rad²")
    velocity: Term = Field(default=Term(), description="tool twist, world axes, s²/m² and s²/rad²")
    force: Term = Field(default=Term(), description="contact force, contact axes, 1/N²")
    force_rate: Term = Field(default=Term(), description="rate of the contact force, force feedback only, s²/N²")


class Phase(Described):
    """What is different in one phase of a task. Terms that are None are the common ones."""

    contact: bool = Field(default=False, description="whether the model is in contact")
    posture: Term | None = None
    joint_velocity: Term | None = None
    torque: Term | None = None
    unfiltered_torque: Term | None = None
    translation: Term | None = None
    rotation: Term | None = None
    velocity: Term | None = None
    force: Term | None = None
    force_rate: Term | None = None

    def over(self, common: Costs) -> Costs:
        """The costs of this phase."""
        own = {name: term for name in Costs.model_fields if (term := getattr(self, name)) is not None}
        return common.model_copy(update=own)
