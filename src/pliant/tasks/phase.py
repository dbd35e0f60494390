"""The parts of a task that is a list of phases: what each does, when it ends, what stands around."""

from __future__ import annotations

import math
from typing import Literal

from pydantic import ConfigDict, Field, model_validator

from pliant.configuration import Config
from pliant.quantity import quantity
from pliant.surfaces import EdgeSurface, HoleSurface
from pliant.tasks.parts import Pose, Vector
from pliant.tasks.timed import CurveConfig, PhaseMotion, WrenchProfile

PerAxis = float | Vector
"""one number for x, y and z, or one for each"""
Mode = Literal["motion", "force", "free"]


class Track(CurveConfig):
    """A motion in free space that starts from rest."""

    shape: Literal["lemniscate", "line", "circle", "hold"] = Field(
        description="lemniscate: across·sin(4πt/T) and up·sin(2πt/T); line: to and fro; circle: from −across, upwards;"
        " hold: one place"
    )
    at: Vector | None = quantity(None, "m", "its middle, world axes; none: where the frame is at home")
    z_axis: Vector | None = Field(default=None, description="where the frame's z axis points; none: as at home")
    nominal: tuple[float, ...] | None = quantity(None, "deg", "joints, where the posture drifts to; none: home")
    beyond_reach: bool = Field(default=False, description="the path may leave what the arm reaches: it stretches")


class Condition(Config):
    """What must hold together so that a phase ends."""

    duration: float | None = quantity(None, "s", "since the phase began", gt=0.0, le=3600.0)
    contact: bool | None = Field(default=None, description="true: contact is felt; false: none is")
    force: float | None = quantity(None, "N", "felt along the phase's wrench, at least", gt=0.0)
    depth: float | None = quantity(None, "m", "gone against the phase's wrench since it began, at least", gt=0.0)
    reached: float | None = quantity(None, "m", "distance from the phase's target, at most", gt=0.0)
    timeout: float | None = quantity(None, "s", "since the phase began; `else` says what then", gt=0.0, le=3600.0)

    @model_validator(mode="after")
    def _says_something(self) -> Condition:
        said = [name for name in type(self).model_fields if getattr(self, name) is not None]
        if not said:
            raise ValueError(f"a condition needs one of {', '.join(type(self).model_fields)}")
        if self.timeout is not None and len(said) > 1:
            raise ValueError("a timeout stands alone: until = { any = [{ contact = true }, { timeout = 8.0 }] }")
        return self

    @property
    def alone(self) -> Literal["", "duration", "timeout"]:
        """The time that is all it asks for; empty: it may never hold."""
        others = (self.contact, self.force, self.depth, self.reached)
        if any(other is not None for other in others):
            return ""
        return "duration" if self.duration is not None else "timeout"


class AnyOf(Config):
    """Several conditions, one of which is enough."""

    any: tuple[Condition, ...] = Field(min_length=1, description="the conditions")


class MotionLimit(Config):
    """Of the motion along force axes."""

    speed: float | None = quantity(
        None, "m/s", "largest; none: where the phase goes towards a contact, what lands gently", gt=0.0
    )
    deviation: float | None = quantity(None, "m", "from where the phase began, largest", gt=0.0)


class Phase(Config):
    """One phase: frames that track a motion, or a target with a wrench."""

    model_config = ConfigDict(populate_by_name=True, serialize_by_alias=True)

    name: str = Field(default="", description="in logs, figures and metrics; empty: its number")
    tracks: dict[str, Track | Literal["posture"]] = Field(
        default={},
        description="frame → motion, the first one; 'posture' for frames that go where the posture puts them",
    )
    frame: str | Pose | None = Field(
        default=None,
        description="axes of target, wrench and modes: world, a thing, or a pose; in a timed list `contact` too: the"
        " world's axes, counted from where the moved frame was when contact began; none: those of the phase before, the"
        " world's at first",
    )
    target: Vector | None = quantity(None, "m", "of the moved frame; none: that of the phase before")
    begin: Vector | None = quantity(
        None, "m", "where the way to the target begins, in a timed list; none: at the target of the phase before"
    )
    via: tuple[Vector, ...] = quantity(
        (), "m", "places on the way to the target, in a timed list: each is reached at rest, in equal times"
    )
    arrive: float | None = quantity(
        None, "s", "when the target is reached, in a timed list; none: when the phase ends at the latest", gt=0.0
    )
    wrench: tuple[float, ...] | None = quantity(
        None, "N, N·m", "desired reaction of what is touched; three axes, or six; none: that of the phase before"
    )
    profile: WrenchProfile | None = Field(
        default=None, description="a wrench that changes, in place of `wrench`, in a timed list"
    )
    modes: tuple[Mode, Mode, Mode, Mode, Mode, Mode] | None = Field(
        default=None, description="of each axis of `frame`, three of motion and three about them; none: as wrench says"
    )
    motion: PhaseMotion | None = Field(default=None, description="curve that begins at the target")
    limit: MotionLimit | None = Field(default=None, description="of the motion along force axes")
    press: float | None = quantity(
        None,
        "s",
        "in which the force is reached once contact is felt, in a timed list from none at the beginning of the phase;"
        " none: there at once, else where the phase goes towards a contact what lands gently; 0: at once",
        ge=0.0,
        le=60.0,
    )
    touch: str | None = Field(default=None, description="thing of the scene that this phase is to touch: it is sought")
    like: str | None = Field(
        default=None, description="phase whose weights a predictive controller takes here; none: those of its own name"
    )
    settle: float = quantity(0.0, "s", "of the phase that its metrics leave out", ge=0.0)
    duration: float | None = quantity(None, "s", "short for until = { duration = … }", gt=0.0, le=3600.0)
    until: Condition | AnyOf | None = Field(
        default=None, description="when the phase ends; one condition or any of several"
    )
    otherwise: Literal["fail", "next"] = Field(
        default="fail", alias="else", description="when the timeout ends it: the run fails, or the next phase begins"
    )

    @model_validator(mode="after")
    def _is_one_thing(self) -> Phase:
        if (self.duration is None) == (self.until is None):
            raise ValueError("a phase needs either duration or until")
        if self.wrench is not None and len(self.wrench) not in (3, 6):
            raise ValueError(f"a wrench has three or six axes, got {len(self.wrench)}")
        if self.wrench is not None and self.profile is not None:
            raise ValueError("a phase has either a wrench or a profile")
        if self.tracks and (self.target or self.wrench or self.modes or self.touch or self.motion or self.limit):
            raise ValueError("a phase with tracks is free: it has no target, wrench, modes, motion, limit or touch")
        return self

    @property
    def last_wrench(self) -> tuple[float, ...] | None:
        """N, N·m at its end; None: that of the phase before."""
        return self.wrench if self.profile is None else self.profile.wrench[-1]

    @property
    def conditions(self) -> tuple[Condition, ...]:
        """Any of which ends the phase."""
        if self.until is None:
            return (Condition(duration=self.duration),)
        return self.until.any if isinstance(self.until, AnyOf) else (self.until,)

    @property
    def longest(self) -> float:
        """s that it can take; infinite where nothing bounds it."""
        sure = (one.timeout if one.alone == "timeout" else one.duration for one in self.conditions if one.alone)
        return min((time for time in sure if time is not None), default=math.inf)


class Thing(Config):
    """Something that stands around."""

    shape: Literal["plane", "box", "ball", "hole", "edge"] = Field(
        description="plane (z of its pose is the normal), box, ball, hole (in a face, along −z) or edge (along x, where"
        " the face towards −y ends)"
    )
    pose: Pose = Field(
        default=Pose(), description="of a plane's point, of a box's or ball's centre, of the middle of a hole's mouth"
    )
    size: Vector = quantity((0.1, 0.1, 0.1), "m", "edges of a box")
    visible: tuple[float, float] = quantity((1.2, 1.2), "m", "edges of the part of a plane that pictures show")
    radius: float = quantity(0.1, "m", "of a ball or a hole", gt=0.0, le=100.0)
    depth: float = quantity(HoleSurface.depth, "m", "of a hole, from its face to its bottom", gt=0.0, le=100.0)
    chamfer: float = quantity(HoleSurface.chamfer, "m", "of a hole's mouth, bevelled by 45°", ge=0.0, le=100.0)
    angle: float = quantity(90.0, "deg", "of an edge: of the material between its two faces", ge=10.0, le=170.0)
    rounding: float = quantity(EdgeSurface.rounding, "m", "of an edge: its radius", ge=0.0, le=100.0)
    mass: float = quantity(0.0, "kg", "of a box or ball; 0: fixed to the world", ge=0.0, le=1e5)
    stiffness: float = quantity(2e4, "N/m", "of each contact", gt=0.0, le=1e9)
    damping: float = quantity(1e2, "N·s/m", "of each contact", ge=0.0, le=1e9)
    friction: float = quantity(0.25, "1", "Coulomb coefficient at rest", ge=0.0, le=10.0)
    friction_moving: float | None = quantity(None, "1", "while sliding; none: as at rest", ge=0.0, le=10.0)
    transition: float = quantity(
        1e-3, "m", "of penetration over which an explicit contact fades in: it is softer before", ge=0.0, le=1.0
    )

    @model_validator(mode="after")
    def _can_be(self) -> Thing:
        if min(self.size) <= 0.0:
            raise ValueError(f"the edges of a box are above zero, got {list(self.size)}")
        if self.shape not in ("box", "ball") and self.mass > 0.0:
            raise ValueError(f"a {self.shape} cannot move: leave its mass out")
        if self.shape == "hole" and self.chamfer >= self.depth:
            raise ValueError(f"a hole is deeper than its bevel, got depth {self.depth:g}, chamfer {self.chamfer:g} m")
        return self


class ImpedanceConfig(Config):
    """How the moved frame gives way, where the controller is an impedance; the references carry it."""

    stiffness: PerAxis = quantity(6000.0, "N/m", "K_0: force per error near the target")
    force_max: PerAxis = quantity(150.0, "N", "F_max: bound of the commanded force")
    range: PerAxis = quantity(0.025, "m", "x_b: error at which F_max is reached, and bound of the exploration")


class TouchingLink(Config):
    """A part of the robot that touches things along its length, beside the moved frame."""

    to: str = Field(description="frame at its other end, on the same body")
    radius: float = quantity(0.02, "m", "of the part", gt=0.0, le=1.0)
    margin: float = quantity(0.0, "m", "left free at the other end, where the frame itself touches", ge=0.0, le=1.0)


class PlannerConfig(Config):
    """How targets that jump become motion."""

    kind: Literal["superposition", "attractor", "printed"] = Field(
        default="superposition",
        description="superposition: never leaves the hull of the targets; attractor: [HapFIC] eq. 2-3, corrected, which"
        " haptic-paper always has; printed: the same as printed",
    )
    speed: float = quantity(0.2, "m/s", "fastest motion of the target", ge=1e-4, le=100.0)
    acceleration: float = quantity(2.0, "m/s²", "largest acceleration of the target", ge=1e-4, le=1e4)
