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

Axes = Literal["local", "world", "surface"]


class Contact(ControllerConfig):
    """Where and how the robot touches."""

    frame: str | None = Field(default=None, description="contact frame; None: the tool frame")
    dimension: Literal[1, 3, 6] = Field(default=1, description="1 normal force, 3 force, 6 force and moment")
    axes: Axes = Field(default="world", description="axes of the force: of the frame, of the world, of the surface")
    normal: tuple[float, float, float] = Field(
        default=(0.0, 0.0, 1.0), description="outward normal of the surface in the world, for axes 'surface'"
    )
    stiffness: tuple[float, ...] = Field(
        default=(1e3,), description="K per axis; the last one repeats", json_schema_extra={"unit": "N/m, N·m/rad"}
    )
    damping: tuple[float, ...] = Field(
        default=(1e2,), description="B per axis; the last one repeats", json_schema_extra={"unit": "N·s/m, N·m·s/rad"}
    )
    integrator: Literal["euler", "exponential"] = Field(
        default="euler", description="of the force: 'euler' [FFMPC] eq. 24, 'exponential' for stiff contacts"
    )
    friction: float | None = Field(
        default=None,
        gt=0.0,
        description="Coulomb coefficient of the predicted contact, force feedback in dimension 3, 6; None: it sticks",
        json_schema_extra={"unit": "1"},
    )
    baumgarte: tuple[float, float] = Field(
        default=(0.0, 0.0),
        description="rigid contact: position and velocity gain of Baumgarte",
        json_schema_extra={"unit": "1/s², 1/s"},
    )


class Bounds(ControllerConfig):
    """Inequalities. With none of them set the solver takes its faster path."""

    torque: bool = Field(default=False, description="keep the control within the robot's torque limits")
    force_max: float | None = Field(
        default=None, gt=0.0, description="0 ≤ normal force ≤ force_max", json_schema_extra={"unit": "N"}
    )
    friction: float | None = Field(
        default=None,
        gt=0.0,
        description="cone: tangential ≤ friction · normal, dimension 3, 6",
        json_schema_extra={"unit": "1"},
    )

    @property
    def any(self) -> bool:
        return self.torque or self.force_max is not None or self.friction is not None


class Compensation(ControllerConfig):
    """What makes a controller free of offsets and bear delays. Everything is off by default."""

    disturbance: bool = Field(
        default=False,
        description="take the estimated disturbance out of the torque, and count it in the prediction over the delay",
    )
    sensing_delay: float = Field(
        default=0.0, ge=0.0, le=0.1, description="age of a reading", json_schema_extra={"unit": "s"}
    )
    computation_delay: float = Field(
        default=0.0,
        ge=0.0,
        le=0.1,
        description="from a reading to the effect of its command",
        json_schema_extra={"unit": "s"},
    )
    averaging: float = Field(
        default=0.0,
        ge=0.0,
        le=0.1,
        description="the torque that is sent is the mean over this time; it removes what rings in the drives",
        json_schema_extra={"unit": "s"},
    )
    force_integral: float = Field(
        default=0.0,
        ge=0.0,
        le=200.0,
        description="k_i: the force reference is shifted by k_i ∫ (reference − measured)",
        json_schema_extra={"unit": "1/s"},
    )
    force_shift_max: float = Field(
        default=20.0, gt=0.0, description="largest shift of the force reference", json_schema_extra={"unit": "N"}
    )
    environment: bool = Field(
        default=False, description="let the estimated stiffness of the environment replace contact.stiffness"
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
    dt: float = Field(default=3e-3, gt=0.0, le=0.1, description="step of the horizon", json_schema_extra={"unit": "s"})
    period: float = Field(
        default=2e-3, gt=0.0, le=0.1, description="time from solve to solve", json_schema_extra={"unit": "s"}
    )
    max_iterations: int = Field(default=8, ge=1, le=1000, description="SQP steps per solve")
    tolerance: float = Field(
        default=1e-4,
        gt=0.0,
        description="KKT residual at which a solve ends",
        json_schema_extra={"unit": "that of the cost's slope"},
    )
    time_budget: float | None = Field(
        default=None, gt=0.0, description="wall time after which no iteration starts", json_schema_extra={"unit": "s"}
    )
    deadline: float | None = Field(
        default=None, gt=0.0, description="wall time of a solve that counts as missed", json_schema_extra={"unit": "s"}
    )
    regularisation: float = Field(
        default=1e-9,
        ge=0.0,
        description="added to the diagonal of the Hessian",
        json_schema_extra={"unit": "that of the cost's curvature"},
    )
    between: Literal["hold", "riccati"] = Field(
        default="hold", description="between two solves: hold the torque, or the solver's own state feedback"
    )
    posture: Literal["start", "reference"] = Field(
        default="reference", description="posture reference: where the controller started, or the task's if it has one"
    )
    gravity: bool = Field(
        default=True, description="the robot's weight is part of the model; off where the robot compensates it itself"
    )
    phase_by: Literal["name", "contact"] = Field(
        default="name",
        description="costs of a phase: those of its name, or the first with the contact that is felt now",
    )
    task_velocity: bool = Field(
        default=True, description="velocity cost about the task's velocity; false: about zero, as in [FFMPC] eq. 25.5"
    )
    contact: Contact = Contact()
    torque_bandwidth: float = Field(
        default=50.0, gt=0.0, description="f_c of the actuation in torque feedback", json_schema_extra={"unit": "Hz"}
    )
    fallback_damping: float = Field(
        default=5.0, ge=0.0, description="joint damping when no plan is left", json_schema_extra={"unit": "N·m·s/rad"}
    )
    max_gap: float = Field(
        default=10.0,
        gt=0.0,
        description="Σ|f(x, u) − x⁺| over states and nodes above which a solution is not used",
        json_schema_extra={"unit": "that of the states"},
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
        """What follows from `kind`."""
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
