"""The signals of the control loop: the only types that are passed between folders.

    measurement ─▶ estimate ─▶ reference ─▶ command ─▶ plant ─▶ measurement

All of them are frozen. Units are SI, angles in radians. Wrenches are the environment's reaction on the robot, linear
part first. `n` is the number of joints. A pose, twist or wrench whose name ends in a frame is expressed at that
frame's origin; in axes aligned with the world unless the field says otherwise.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any

import numpy as np
import numpy.typing as npt

from pliant.axis_modes import AxisModes
from pliant.environment import Environment, EstimatedSurface
from pliant.errors import ConfigError
from pliant.frozen import quick
from pliant.spatial import Array, as_vector

_NOTHING: Mapping[str, Any] = MappingProxyType({})


def _nothing() -> Mapping[str, Any]:
    return _NOTHING


@quick
class Measurement:
    """Readings of the sensors at one instant, with their imperfections."""

    time: float
    """s since the start of the run"""
    q: Array
    """(n,) joint positions, rad"""
    v: Array
    """(n,) joint velocities, rad/s"""
    torque: Array
    """(n,) torque at the link side of each joint, N·m"""
    torque_sent: Array
    """(n,) torque that was sent in the period that ends now, after every limit, N·m"""
    wrenches: Mapping[str, Array] = field(default_factory=_nothing)
    """frame → (6,) wrench of a force/torque sensor at that frame, in the frame's own axes, N and N·m. It includes
    everything beyond the sensor, also weight and inertia of the tool."""


@quick
class Estimate:
    """What the robot believes: the measurement filtered, compensated and completed."""

    time: float
    q: Array
    """(n,) rad"""
    v: Array
    """(n,) rad/s"""
    torque: Array
    """(n,) N·m"""
    torque_sent: Array
    """(n,) N·m"""
    wrenches: Mapping[str, Array] = field(default_factory=_nothing)
    """frame → (6,) contact wrench at that frame, world axes, tool weight and bias removed"""
    contacts: Mapping[str, bool] = field(default_factory=_nothing)
    """frame → whether it is believed to touch something"""
    disturbance: Array | None = None
    """(n,) joint torque that the model does not explain, N·m, where an observer runs"""
    environments: Mapping[str, Environment] = field(default_factory=_nothing)
    """frame → stiffness and damping of its contact, where they are estimated"""
    surfaces: Mapping[str, EstimatedSurface] = field(default_factory=_nothing)
    """frame → pose of the surface that it has touched, where that is estimated"""


@dataclass(frozen=True, slots=True)
class ImpedanceTuning:
    """Parameters of one fractal impedance task, one entry per axis (3, or 6 with rotation). Swapped whole.

    The force grows with `stiffness` up to the error `linear_range`, then bends towards `force_max`, which it reaches
    (to within a fraction of a percent) at `range`. An axis with stiffness and force_max both zero is off.

    Raises:
        ConfigError: on construction, if the parameters are impossible (names the axis and the numbers).
    """

    stiffness: Array
    """K_0 (k,), N/m and N·m/rad"""
    force_max: Array
    """F_max (k,), N and N·m"""
    range: Array
    """x_b (k,), m and rad: the error at which F_max is reached"""
    linear_range: Array | None = None
    """x_0 (k,), m and rad: the end of the linear part. None: derived from the profile (0.95 x_b, or where 0.95 F_max
    is reached)"""

    def __post_init__(self) -> None:
        size = np.atleast_1d(np.asarray(self.range)).shape[0]
        for name in ("stiffness", "force_max", "range", "linear_range"):
            value = getattr(self, name)
            vector = None if value is None else as_vector(value, size, name)
            if vector is not None and np.any(vector < 0.0):
                raise ConfigError(f"{name} must not be negative, got {vector.tolist()}")
            object.__setattr__(self, name, vector)
        off = (self.stiffness == 0.0) & (self.force_max == 0.0)
        if np.any((self.stiffness == 0.0) & ~off):
            raise ConfigError(
                f"stiffness 0 needs force_max 0 (an axis that is off), got stiffness {self.stiffness.tolist()}"
                f" with force_max {self.force_max.tolist()}"
            )
        if np.any(~off & ~(self.range > 0.0)):
            raise ConfigError(f"range (x_b) must be above zero on an active axis, got {self.range.tolist()}")
        if self.linear_range is not None:
            self._check_linear_range(off, self.linear_range)

    def _check_linear_range(self, off: npt.NDArray[np.bool_], linear_range: Array) -> None:
        for axis in np.flatnonzero(~off):
            K_0, F_max = float(self.stiffness[axis]), float(self.force_max[axis])
            x_0, x_b = float(linear_range[axis]), float(self.range[axis])
            if x_b <= x_0:
                raise ConfigError(
                    f"axis {axis}: range x_b must exceed linear_range x_0, got x_b = {x_b:g}, x_0 = {x_0:g}"
                )
            if F_max < K_0 * x_0:
                raise ConfigError(
                    f"axis {axis}: force_max must be at least stiffness · linear_range, got F_max = {F_max:g} <"
                    f" {K_0:g} · {x_0:g} = {K_0 * x_0:g}"
                )

    @property
    def axes(self) -> int:
        """Number of axes, 3 or 6."""
        return int(self.range.shape[0])


@quick
class TaskReference:
    """Where one frame should be, how it should move, and how hard it should press."""

    frame: str
    position: Array
    """(3,) of the frame's origin in the world, m"""
    rotation: Array | None = None
    """R_world_frame (3, 3); None leaves the orientation free"""
    velocity: Array = field(default_factory=lambda: np.zeros(6))
    """(6,) twist, world axes, m/s and rad/s"""
    acceleration: Array = field(default_factory=lambda: np.zeros(6))
    """(6,) m/s² and rad/s²"""
    wrench: Array = field(default_factory=lambda: np.zeros(6))
    """(6,) desired reaction of the environment, N and N·m (pressing 40 N on a floor: +40 along z)"""
    tuning: ImpedanceTuning | None = None
    """None: the controller's own"""
    task_rotation: Array | None = None
    """R_world_task (3, 3); its third column is the believed outward normal of the surface. None: the world's"""
    modes: AxisModes | None = None
    """of each axis; None: force along what the wrench presses, motion elsewhere"""


@quick
class Preview:
    """The reference at the nodes of a prediction horizon, N + 1 instants from now on."""

    time: Array
    """(N+1,) s"""
    position: Array
    """(N+1, 3) m"""
    rotation: Array | None
    """(N+1, 3, 3) R_world_frame; None leaves the orientation free"""
    velocity: Array
    """(N+1, 6) twist, m/s and rad/s"""
    wrench: Array
    """(N+1, 6) desired reaction, N and N·m"""
    phase: tuple[str, ...] = ()
    """(N+1,) name of the phase at each node"""
    posture: Array | None = None
    """(N+1, n) joint configuration that goes with the task, rad"""
    task_rotation: Array | None = None
    """(N+1, 3, 3) R_world_task at each node; None: the world's axes"""


@quick
class Reference:
    """What the robot should do now."""

    time: float
    tasks: tuple[TaskReference, ...] = ()
    """one entry per controlled frame, the most important first"""
    posture: Array | None = None
    """(n,) joint configuration that goes with the tasks, rad"""
    phase: str = ""
    """name of the phase of the task, for people and logs"""
    preview: Preview | None = None
    """the first task over a horizon"""
    tuning: Any = None
    """a frozen value with weights or gains of the whole controller (None: its own)"""
    diagnostics: Mapping[str, float | Array] = field(default_factory=_nothing)
    """channel → value, for the log: states and outputs of planners and exploration"""


@quick
class Command:
    """What the controller asks of the actuators."""

    time: float
    """time of the estimate it was computed from, s"""
    torque: Array
    """(n,) N·m, finite and within the limits"""
    clamped: Array
    """(n,) what the torque limits took away: wanted minus torque, N·m"""
    diagnostics: Mapping[str, float | Array] = field(default_factory=_nothing)
    """channel → value, for the log"""


@quick
class Truth:
    """True state of a simulated world. Only metrics and figures use it; no controller does."""

    time: float
    q: Array
    v: Array
    torque: Array
    """(n,) torque that acts at the link side, N·m"""
    positions: Mapping[str, Array] = field(default_factory=_nothing)
    """frame → (3,) m"""
    rotations: Mapping[str, Array] = field(default_factory=_nothing)
    """frame → (3, 3) R_world_frame"""
    wrenches: Mapping[str, Array] = field(default_factory=_nothing)
    """frame → (6,) contact wrench on the robot at that frame, world axes"""
    objects: Mapping[str, Array] = field(default_factory=_nothing)
    """object → (7,) position and quaternion (w, x, y, z) of every body in the scene that can move"""
    limit_excess: Array | None = None
    """(n,) by how much each joint stands beyond its position limit, rad (m where it slides); 0 within; None: unknown"""


@quick
class Tick:
    """One cycle of the loop, for observers."""

    measurement: Measurement
    estimate: Estimate
    reference: Reference
    command: Command
    truth: Truth | None
    """None on a real robot"""
    wall: Mapping[str, float] = field(default_factory=_nothing)
    """stage → seconds of wall time it took; never part of the reproducible log"""
    guard: int = 0
    """fault that the guard found in this tick, a `pliant.guard.Fault`; 0: nothing"""
