"""Typed face of the compiled chain of estimators (cpp/estimation)."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from pliant._loop import Part
from pliant.spatial import Array

FIT_SIZE: int
"""numbers that an `EnvironmentFit` remembers"""
FIT_FOUND: int
"""the first of five among them: 1 where a belief is known, then stiffness, damping and the uncertainty of both"""
FIT_COVARIANCE: int
"""the first of nine: the (3, 3) covariance of depth, rate and force"""

def filter_step(filter: tuple[float, float, float, float, float], values: Array, first: Array, second: Array) -> None:
    """Filters values (k,) in place; coefficients b_0, b_1, b_2, a_1, a_2, and memory (k,) twice, written over."""

class Tree:
    """Rigid bodies on a fixed base, joined by joints of one degree of freedom.

    Raises ValueError: a joint before its parent, a frame of a joint that there is not, sizes that are wrong.
    """

    def __init__(
        self,
        joints: Sequence[
            tuple[
                int,
                tuple[Sequence[float], Sequence[float]],
                Sequence[float],
                bool,
                float,
                Sequence[float],
                Sequence[float],
                float,
            ]
        ],
        frames: Sequence[tuple[str, int, tuple[Sequence[float], Sequence[float]]]],
        gravity: Sequence[float],
    ) -> None:
        """joints: parent or -1, placement (R (9,), p (3,) m), axis (3,), whether it slides, kg, centre (3,) m, inertia
        (9,) kg m², rotor kg m²; frames: name, joint or -1, placement; gravity (3,) m/s²."""

class Surface:
    """A surface with a distance and a normal at every place."""

class Plane(Surface):
    """A plane."""

    def __init__(self, origin: Sequence[float], normal: Sequence[float]) -> None:
        """origin (3,) m; normal (3,) of length one."""

class PythonSurface(Surface):
    """A surface that is asked in Python."""

    def __init__(self, near: Callable[[tuple[float, float, float]], Any]) -> None:
        """near: place (3,) m → distance in m, outward normal (3,), …"""

class EnvironmentFit:
    """Least squares with forgetting of F = K p + B ṗ + c."""

    def __init__(
        self,
        *,
        filter: tuple[float, float, float, float, float],
        touch: float,
        least_force: float,
        least_motion: float,
        noise: tuple[float, float],
        correlated: float,
        samples: float,
        least_samples: float,
        accuracy: float,
        drift: float = 0.0,
    ) -> None:
        """filter: of all three signals; touch N; least changes N and m; noise: variances of depth (m²) and rate (m²/s²)
        after the filter; correlated, samples, least_samples: numbers of samples; accuracy: of K, relative; drift: share
        of a new sample in the slow mean that is taken off, 0: none."""

    def step(self, force: float, depth: float, rate: float, memory: Array) -> None:
        """One sample, N, m, m/s; writes over memory (FIT_SIZE,)."""

class Stage:
    """A part of a chain."""

    @property
    def in_python(self) -> bool:
        """Whether it asks anything in Python, as a surface that is not compiled."""

class WrenchStage(Stage):
    """Joint signals as they are, contact wrenches, and what touches."""

    def __init__(
        self,
        *,
        robot: Tree | None,
        velocity_gain: float,
        begin: float,
        end: float,
        linger: float,
        carried: Mapping[str, tuple[float, Sequence[float], Sequence[float], Sequence[float]]],
        contact_frames: Mapping[str, str],
        acceleration_cutoff: float,
        tare: tuple[float, bool, float] | None,
    ) -> None:
        """Without a robot it looks at no wrench. begin, end N, linger s; carried: sensor → kg, centre (3,) m, bias (6,)
        N and N·m, inertia (9,) kg m²; acceleration_cutoff Hz; tare: s, whether it is a weight, rad/s."""

class JointStateStage(Stage):
    """Joint positions from velocities and positions."""

    def __init__(self, memory: float) -> None:
        """memory: s."""

class FilteredStage(Stage):
    """Low-pass filters."""

    def __init__(
        self,
        *,
        velocity: tuple[float, float, float, float, float] | None,
        torque: tuple[float, float, float, float, float] | None,
        wrench: tuple[float, float, float, float, float] | None,
    ) -> None:
        """Coefficients b_0, b_1, b_2, a_1, a_2 of each."""

class EnvironmentStage(Stage):
    """Stiffness and damping of what one frame touches."""

    def __init__(
        self, robot: Tree, frame: str, surface: Surface, fit: EnvironmentFit, sliding: float, reach: float, kept: float
    ) -> None:
        """sliding: m/s above which nothing is learnt; reach: m from where it was found beyond which one
        softer than `kept` N/m is dropped."""

class MomentumStage(Stage):
    """The generalised-momentum observer."""

    def __init__(
        self,
        *,
        robot: Tree,
        gain: float,
        measured: bool,
        surface: Surface,
        along_normal: bool,
        frames: Sequence[str] | None,
        gravity: bool,
        coriolis: bool,
        late: int,
    ) -> None:
        """gain rad/s; measured: the sensors' torque, else the one sent; frames whose wrenches count, None: all;
        gravity, coriolis: what is compensated; late: periods."""

class Chain:
    """Stages for n joints and wrenches of given names.

    Raises ValueError: a signal that does not fit them.
    """

    def __init__(self, stages: Sequence[Stage], n: int, frames: Sequence[str], completes: bool) -> None:
        """frames: names of the wrenches that go in; completes: they are those of an estimate, else of a measurement."""

    @property
    def frames(self) -> list[str]:
        """Names of the wrenches that come out."""

    @property
    def rows(self) -> int:
        """Rows of wrenches in `out`."""

    @property
    def memory_size(self) -> int: ...
    @property
    def belief_size(self) -> int:
        """Numbers of an estimate: q, v, torque, disturbance (n each), wrenches (rows, 6), touches (rows), environment
        (4)."""

    def init(self, measurement: Any, estimate: Any, memory: Array, out: Array) -> tuple[str, float, float] | None:
        """Writes the memory before the first step. Returns a fault with two numbers, or None."""

    def step(self, measurement: Any, estimate: Any, memory: Array, out: Array) -> tuple[str, float, float] | None:
        """Writes the next memory and the estimate. Returns a fault with two numbers, or None."""

class ChainPart(Part):
    """A chain as a part of a compiled loop."""

    def __init__(
        self, stages: Sequence[Stage], n: int, frames: Sequence[str], measured: Sequence[int], begin: int
    ) -> None:
        """Args: stages; number of joints; frames of the sensors; where a row has the measurement's time, q, v, torque,
        torque sent and wrenches; where the estimate begins, in the order of `Chain.step`."""
