"""Typed face of the compiled plant (cpp/plant): a simulated robot's period in MuJoCo, and the imperfect robot."""

from collections.abc import Sequence
from typing import Any

from pliant._loop import World
from pliant.spatial import Array

MUJOCO_VERSION: int
"""of the headers that this was compiled with"""

def same_layout(model: Any, data: Any) -> bool:
    """Whether those headers find sizes, arrays and contacts of a MuJoCo model and data where they are."""

class Physics:
    """A control period of one MuJoCo model: a torque held over a few physics steps, what touches, what sensors read.

    Raises ValueError: values that do not fit the model.
    """

    def __init__(
        self,
        model: Any,
        functions: Sequence[int],
        substeps: int,
        coriolis: bool,
        limit: Sequence[float],
        fastest: Sequence[float],
        frame_of_geom: Sequence[int],
        frame_site: Sequence[int],
        frame_of_slot: Sequence[int],
        sensors: Sequence[tuple[int, float, Sequence[float], Sequence[float], Sequence[int]]],
        pushes: Sequence[tuple[int, Sequence[float], float, float]],
    ) -> None:
        """functions: addresses in the loaded library (`mujoco_library.FUNCTIONS`); limit (n,) N·m; fastest (n,) rad/s;
        frame_of_geom (ngeom,) contact frame of each geom or -1; frame_site: site of each contact frame;
        frame_of_slot: contact frame of each explicit contact or -1; sensors: site,
        kg carried, centre (3,) m, inertia (9,) kg m², contact frames beyond; pushes: site, force (3,) N, from, to s."""

    @property
    def outcome_size(self) -> int:
        """Numbers of a period: q, v, torque (n each), wrench of each contact frame, reading of each sensor (6 each)."""

    def step(
        self, data: Any, torque: Array, pushes: Sequence[tuple[int, Sequence[float], float, float]], out: Array
    ) -> int:
        """Holds a torque (n,) within the limits for a period; writes `out`. Returns a bit for each contact frame that
        touches, or -1 where a joint's speed is not finite or not allowed."""

    def hold(
        self, data: Any, torque: Array, pushes: Sequence[tuple[int, Sequence[float], float, float]], out: Array
    ) -> None:
        """Holds a torque (n,) within the limits, and the pushes of this instant, over steps that are made elsewhere;
        writes the torque into `out`."""

    def read(self, data: Any, force: Array, point: Array, out: Array) -> int:
        """What came of them; writes the rest of `out`. Args: force (slots, 3) N and point (slots, 3) m of the explicit
        contacts. Returns what `step` returns."""

class TruthRow:
    """What is true of a world of one MuJoCo model, as a row of numbers.

    Raises ValueError: values that do not fit the model.
    """

    def __init__(
        self, model: Any, lower: Sequence[float], upper: Sequence[float], sites: Sequence[int], bodies: Sequence[int]
    ) -> None:
        """lower, upper: (n,) limits of the joints, which are the model's first ones, rad or m."""

    @property
    def size(self) -> int:
        """Numbers in the row: q, v, torque applied, how far beyond its limits each joint is (n each); positions
        (sites, 3); rotations (sites, 9); position and quaternion of the bodies (bodies, 7)."""

    def read(self, data: Any, out: Array) -> None:
        """Reads a MuJoCo data of the model into `out` (size,)."""

class ImperfectRobot:
    """An imperfect robot round a perfect one. What it remembers is one row of numbers, `memory`.

    Raises ValueError: values that do not fit the robot.
    """

    def __init__(
        self,
        *,
        n: int,
        frames: int,
        ticks: int,
        inner: int,
        under_way: int,
        limit: Sequence[float],
        dry: Sequence[float],
        viscous: Sequence[float],
        noise: Sequence[float],
        friction_velocity: float,
        kept: float,
        loop: Sequence[float],
        ripple: Sequence[float],
        late: Sequence[int],
        noise_q: Sequence[float],
        noise_v: Sequence[float],
        noise_torque: Sequence[float],
        noise_wrench: Sequence[float],
    ) -> None:
        """ticks: corrections of the torque loop in a period; inner: steps of the perfect robot in each; under_way:
        corrections from command to effect; loop: period s, K_P, K_I, K_D; ripple: N, Hz, rad/s, N; late: corrections
        by which q, v and wrenches, torques, and further the wrenches are late."""

    @property
    def memory_size(self) -> int:
        """Numbers that it remembers."""

    @property
    def draws(self) -> int:
        """Standard normal numbers of a correction: (inner, n) of the gears, then q, v, torque, wrenches."""

    @property
    def reading_size(self) -> int:
        """Numbers of a reading: q, v, torque, torque sent (n each), 6 of each force/torque sensor."""

    def init(
        self,
        memory: Array,
        held: Array,
        gain: Array,
        bias: Array,
        sensor_gain: Array,
        sensor_offset: Array,
        now: Array,
        draw: Array,
        out: Array,
    ) -> None:
        """Starts with a held torque (n,) and what is true now (q, v, torque, wrenches in a row); writes a reading."""

    def drive(self, memory: Array, command: Array, asked: Array) -> None:
        """A correction begins: writes what is asked of the drives (n,) N·m."""

    def gear(self, memory: Array, draw: Array, index: int, torque: Array) -> None:
        """Writes the torque at the link side (n,) over step `index` of the perfect robot."""

    def moved(self, memory: Array, v: Array) -> None:
        """Tells the true velocity (n,) after a step."""

    def sense(self, memory: Array, draw: Array, now: Array, out: Array) -> None:
        """A correction ends: writes a reading of what is true now, all but the torque that was sent."""

    def period(
        self,
        memory: Array,
        draws: Array,
        robot: Physics,
        data: Any,
        command: Array,
        pushes: Sequence[tuple[int, Sequence[float], float, float]],
        out: Array,
    ) -> int:
        """A whole period round a compiled robot, without the GIL: writes a reading and the robot's own outcome.
        Returns what `Physics.step` returns."""

class SimulatedRobot(World):
    """A simulated robot as the world of a compiled loop. Raises ValueError: values that do not fit it."""

    def __init__(self, physics: Physics, truth: TruthRow, data: Any, period: float, at: Sequence[int]) -> None:
        """Args: the robot; what is true of it; its MuJoCo data; control period, s; where a row has its time, the
        command's torque, the outcome of a period and what is true."""

    @property
    def touching(self) -> int:
        """What `Physics.step` returned for the last period."""

    def begin(self, periods: int, pushes: Sequence[tuple[int, Sequence[float], float, float]]) -> None:
        """A block begins. Args: periods since the start; pushes beside those of the robot."""

class ImperfectWorld(SimulatedRobot):
    """The same with imperfect sensors and actuators. An outcome is a reading, then that of the robot inside."""

    def __init__(
        self,
        chain: ImperfectRobot,
        physics: Physics,
        truth: TruthRow,
        data: Any,
        period: float,
        at: Sequence[int],
        memory: Array,
    ) -> None:
        """Args: what is imperfect; the others as of `SimulatedRobot`, the period that of the robot inside; what the
        imperfect robot remembers, which is written over."""

    def draw(self, draws: Array) -> None:
        """Told before a block: the standard normal numbers of its periods, side by side, which are read where they
        lie."""
