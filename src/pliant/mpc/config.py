"""Typed configuration of a predictive controller, and the defaults of the three controllers of [FFMPC].

[FFMPC]: Kleff, Jordana, Mansard, Righetti, "Force feedback in model predictive control: a soft contact approach", 2024.
The default weights are those of its authors' polishing task.
"""

from __future__ import annotations

from typing import Literal

from pydantic import Field, model_validator

from pliant.entries import ControllerConfig
from pliant.mpc.costs import Costs, PhaseCosts
from pliant.mpc.models import MODELS, Kind, PredictiveModel
from pliant.quantity import quantity

Axes = Literal["local", "world", "surface"]


class Contact(ControllerConfig):
    """Contact of the robot: frame, dimension and model."""

    frame: str | None = Field(default=None, description="contact frame; None: the tool frame")
    dimension: Literal[1, 3, 6] = Field(default=1, description="1 normal force, 3 force, 6 force and moment")
    axes: Axes = Field(default="world", description="axes of the force: of the frame, of the world, of the surface")
    normal: tuple[float, float, float] = Field(
        default=(0.0, 0.0, 1.0), description="outward normal of the surface in the world, for axes 'surface'"
    )
    stiffness: tuple[float, ...] = quantity((1e3,), "N/m, N·m/rad", "K per axis; the last one repeats")
    damping: tuple[float, ...] = quantity((1e2,), "N·s/m, N·m·s/rad", "B per axis; the last one repeats")
    integrator: Literal["euler", "exponential"] = Field(
        default="euler", description="of the force: 'euler' [FFMPC] eq. 24, 'exponential' for stiff contacts"
    )
    friction: float | None = quantity(
        None,
        "1",
        "Coulomb coefficient of the predicted contact, force feedback in dimension 3, 6; None: it sticks",
        gt=0.0,
    )
    baumgarte: tuple[float, float] = quantity(
        (0.0, 0.0), "1/s², 1/s", "rigid contact: position and velocity gain of Baumgarte"
    )


class Bounds(ControllerConfig):
    """Inequality constraints. Without any the solver uses a faster method."""

    torque: bool = Field(default=False, description="keep the control within the robot's torque limits")
    force_max: float | None = quantity(None, "N", "0 ≤ normal force ≤ force_max", gt=0.0)
    friction: float | None = quantity(None, "1", "cone: tangential ≤ friction · normal, dimension 3, 6", gt=0.0)

    @property
    def any(self) -> bool:
        return self.torque or self.force_max is not None or self.friction is not None


class Compensation(ControllerConfig):
    """Offset-free control and compensation of delays. Everything is off by default."""

    disturbance: bool = Field(
        default=False,
        description="subtract the estimated disturbance from the torque, and use it in the prediction over the delay",
    )
    sensing_delay: float = quantity(0.0, "s", "age of a reading", ge=0.0, le=0.1)
    computation_delay: float = quantity(0.0, "s", "from a reading to the effect of its command", ge=0.0, le=0.1)
    averaging: float = quantity(
        0.0,
        "s",
        "the torque that is sent is the mean over this time; it removes oscillations of the drives",
        ge=0.0,
        le=0.1,
    )
    force_integral: float = quantity(
        0.0, "1/s", "k_i: the force reference is shifted by k_i ∫ (reference − measured)", ge=0.0, le=200.0
    )
    force_shift_max: float = quantity(20.0, "N", "largest shift of the force reference", gt=0.0)
    environment: bool = Field(
        default=False,
        description="let the estimated stiffness of the environment replace contact.stiffness, while there is one",
    )
    environment_damping: bool = Field(
        default=False,
        description="with `environment`: its damping replaces contact.damping, too, where its standard uncertainty and"
        " K times the period, the effect of a force that is a period late, are at most 20 % of it",
    )

    @property
    def delay(self) -> float:
        """Age of a reading when the command that answers to it takes effect, s."""
        return self.sensing_delay + self.computation_delay

    @property
    def any(self) -> bool:
        return self != Compensation()


class MpcConfig(ControllerConfig):
    """A predictive controller."""

    kind: Kind = Field(default="force_feedback", description="which model predicts")
    frame: str = Field(default="tool", description="frame whose pose is tracked")
    horizon: int = Field(default=5, ge=1, le=200, description="N, running nodes")
    dt: float = quantity(3e-3, "s", "step of the horizon", gt=0.0, le=0.1)
    period: float = quantity(2e-3, "s", "time from solve to solve", gt=0.0, le=0.1)
    max_iterations: int = Field(default=8, ge=1, le=1000, description="SQP steps per solve")
    tolerance: float = quantity(1e-4, "that of the cost's slope", "KKT residual at which a solve ends", gt=0.0)
    time_budget: float | None = quantity(None, "s", "wall time after which no iteration starts", gt=0.0)
    deadline: float | None = quantity(None, "s", "wall time of a solve that counts as missed", gt=0.0)
    regularisation: float = quantity(
        1e-9, "that of the cost's curvature", "added to the diagonal of the Hessian", ge=0.0
    )
    between: Literal["hold", "riccati"] = Field(
        default="hold", description="between two solves: hold the torque, or the solver's own state feedback"
    )
    posture: Literal["start", "reference"] = Field(
        default="reference", description="posture reference: the posture at the start, or the task's if it has one"
    )
    gravity: bool = Field(
        default=True, description="the robot's weight is part of the model; off where the robot compensates it itself"
    )
    phase_by: Literal["name", "contact"] = Field(
        default="name",
        description="costs of a phase: those of its name, or the first one that matches the present contact state",
    )
    task_velocity: bool = Field(
        default=True, description="velocity cost about the task's velocity; false: about zero, as in [FFMPC] eq. 25.5"
    )
    contact: Contact = Contact()
    torque_bandwidth: float = quantity(50.0, "Hz", "f_c of the actuation in torque feedback", gt=0.0)
    fallback_damping: float = quantity(5.0, "N·m·s/rad", "joint damping after the last usable plan has ended", ge=0.0)
    max_gap: float = quantity(
        10.0, "that of the states", "Σ|f(x, u) − x⁺| over states and nodes above which a solution is not used", gt=0.0
    )
    bounds: Bounds = Bounds()
    compensation: Compensation = Compensation()
    costs: Costs = Costs()
    phases: dict[str, PhaseCosts] = Field(
        default={"free": PhaseCosts(), "contact": PhaseCosts(contact=True)},
        min_length=1,
        description="costs of each phase by name",
    )

    @property
    def predictive_model(self) -> PredictiveModel:
        """Properties of the model, from `kind`."""
        return MODELS[self.kind]

    @model_validator(mode="after")
    def _consistent(self) -> MpcConfig:
        for name, value in (("stiffness", self.contact.stiffness), ("damping", self.contact.damping)):
            if len(value) > self.contact.dimension:
                raise ValueError(f"contact.{name} has {len(value)} entries, the contact has {self.contact.dimension}")
            if not all(entry > 0.0 for entry in value):
                raise ValueError(f"contact.{name} must be above zero on every axis, got {list(value)}")
        if self.bounds.friction is not None and self.contact.dimension == 1:
            raise ValueError("bounds.friction needs a contact of dimension 3 or 6, got 1")
        self._check_sliding()
        if self.predictive_model.torque_state and self.between == "riccati":
            raise ValueError("between = 'riccati' needs the torque as control; torque feedback filters it: use 'hold'")
        if self.between == "riccati" and (self.compensation.delay or self.compensation.averaging):
            raise ValueError("between = 'riccati' answers to the present state: with delays or averaging use 'hold'")
        return self

    def _check_sliding(self) -> None:
        contact = self.contact
        if contact.friction is None:
            return
        if not self.predictive_model.force_state:
            raise ValueError(
                f"contact.friction is part of the model of kind 'force_feedback', got kind {self.kind!r}: leave it out,"
                " or bound the force with bounds.friction"
            )
        if contact.dimension == 1:
            raise ValueError("contact.friction needs a contact of dimension 3 or 6, got 1")
        if contact.integrator == "exponential":
            raise ValueError(
                "contact.friction needs contact.integrator = 'euler', got 'exponential', which solves a contact that"
                " does not slide"
            )
