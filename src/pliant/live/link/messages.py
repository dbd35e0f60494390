"""Messages between the loop and the page. Frozen values; only the latest of each kind counts, unless it is `Queued`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

from pliant.entries import ControllerConfig
from pliant.environment import Environment, EstimatedSurface
from pliant.experiments.base import CaseConfig
from pliant.live.page.task_error import TaskError
from pliant.simulation import Imperfections, Scene
from pliant.spatial import Array
from pliant.visual_shapes import Look


class Queued:
    """Marks messages that are all delivered, in their order."""

    __slots__ = ()


# ---------------------------------------------------------------------- page → loop


@dataclass(frozen=True, slots=True)
class Begin:
    """Start a new run."""

    study: str
    config: CaseConfig
    fresh: bool = True
    """False: surfaces, imperfections and target stay as the page left them"""
    refused: str = ""
    """why another run, which was asked for, cannot be: this one ran before it"""


@dataclass(frozen=True, slots=True)
class Parameters:
    """The configuration with other parameters of the controller; they take effect between two periods."""

    config: CaseConfig


@dataclass(frozen=True, slots=True)
class Surroundings:
    """The scene with other surfaces; the robot and everything that moves stay where they are."""

    scene: Scene


@dataclass(frozen=True, slots=True)
class NewImperfections:
    """The robot with other imperfections."""

    config: Imperfections


@dataclass(frozen=True, slots=True)
class Aim:
    """Offset of the first task from its own reference, and a factor on its desired force."""

    offset: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """m, world axes"""
    force_scale: float = 1.0
    """factor on the desired wrench"""


@dataclass(frozen=True, slots=True)
class TaskScaling:
    """Factors on the force and the speed of the task, from the sliders of the page."""

    force: float = 1.0
    """factor on every desired wrench"""
    speed: float = 1.0
    """factor on the speed of the task; above zero"""


@dataclass(frozen=True, slots=True)
class Flow:
    """How simulated time passes."""

    playing: bool = True
    speed: float = 1.0
    """simulated seconds per second of wall time"""
    repeat: bool = True
    """start again where the run ends"""


@dataclass(frozen=True, slots=True)
class StepOnce(Queued):
    """Run some periods while paused."""

    periods: int = 1


@dataclass(frozen=True, slots=True)
class PushNow(Queued):
    """Apply a constant force to a frame from now on."""

    frame: str
    force: tuple[float, float, float]
    """N, world axes"""
    duration: float
    """s"""


@dataclass(frozen=True, slots=True)
class Pull:
    """A force that a user drags with the mouse. It ends by itself unless it is renewed, because a browser may close."""

    frame: str
    force: tuple[float, float, float]
    """N, world axes; zero ends it"""


@dataclass(frozen=True, slots=True)
class Record(Queued):
    """Start a log in a file, or stop it."""

    path: Path | None


# ---------------------------------------------------------------------- loop → page


@dataclass(frozen=True, slots=True)
class Ready(Queued):
    """A run begins: what can be shown and changed."""

    run: int
    """number of the run; pictures and samples carry it too"""
    study: str
    config: CaseConfig
    looks: tuple[Look, ...]
    bodies: int
    frames: tuple[str, ...]
    """frames of the robot that can be pushed"""
    columns: tuple[str, ...]
    """of the samples that follow"""
    period: float
    """s"""
    scene: Scene | None
    """None: it cannot be changed here"""
    imperfections: Imperfections | None
    """None: they cannot be changed here"""
    warnings: tuple[str, ...] = ()
    restarts: bool = True
    """whether something else can be chosen to run"""
    refused: str = ""
    """why what was asked for does not run; empty: it does"""
    parameters: ControllerConfig | None = None
    """of the controller, as they are now; None: not known"""


@dataclass(frozen=True, slots=True)
class SceneChanged(Queued):
    """The shapes of the scene have changed."""

    looks: tuple[Look, ...]
    scene: Scene


@dataclass(frozen=True, slots=True)
class Picture:
    """The scene at one instant."""

    run: int
    time: float
    """s"""
    positions: Array
    """(bodies, 3) m"""
    quaternions: Array
    """(bodies, 4) w, x, y, z"""
    ghost: tuple[Array, Array] | None
    """the same for the reference's posture; None if it has none"""
    tool: Array
    """(3,) m, frame of the first task"""
    target: Array | None
    """(3,) m, where it should be; None without a task"""
    nominal: Array | None
    """(3,) m, the same without the offset from the page"""
    contacts: Mapping[str, tuple[Array, Array]]
    """frame → its position (3,) m and the force (3,) N on the robot there"""
    asked: Array
    """(3,) N, desired contact force of the first frame (from the controller or the reference), as a reaction on the
    robot"""
    predicted_path: Array | None = None
    """(N, 3) m"""
    predicted_force: Array | None = None
    """(N, 3) N"""
    pushes: Mapping[str, tuple[Array, Array]] = field(default_factory=dict[str, tuple[Array, Array]])
    """frame → its position (3,) m and the external force (3,) N on it"""
    phase: str = ""
    error: TaskError | None = None
    """of the first frame, while it presses"""
    environments: Mapping[str, Environment] = field(default_factory=dict[str, Environment])
    """frame → estimated stiffness and damping of the contact, where they are estimated"""
    surfaces: Mapping[str, EstimatedSurface] = field(default_factory=dict[str, EstimatedSurface])
    """frame → estimated orientation of the surface it touched, where that is estimated"""


@dataclass(frozen=True, slots=True)
class Pulse:
    """State of the loop: time, speed, missed deadlines."""

    time: float
    """s"""
    playing: bool
    real_time_factor: float
    """simulated seconds per second of wall time, of the last second"""
    missed: int
    """periods in which planning and control took longer than the period, since the start"""
    ticks: int
    recording: Path | None
    ended: str | None = None
    """why the run has stopped"""
    phase: str = ""
    """of the task"""


@dataclass(frozen=True, slots=True)
class Samples(Queued):
    """New samples of the curves."""

    run: int
    """number of the run that it belongs to"""
    rows: Array
    """(k, columns), the first is the time in s"""


@dataclass(frozen=True, slots=True)
class Note(Queued):
    """A message for the user."""

    kind: Literal["refused", "failed", "recorded", "note"]
    text: str


Message = (
    Begin | Parameters | Surroundings | NewImperfections | Aim | TaskScaling | Flow | StepOnce | PushNow | Pull | Record
    | Ready | SceneChanged | Picture | Pulse | Samples | Note
)  # fmt: skip
