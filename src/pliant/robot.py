"""A robot: its rigid-body model, frames, limits and looks, from a URDF, an MJCF or a catalogue name."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from pliant.errors import ConfigError, RobotError, ShapeError, SignalError, options
from pliant.robots import CATALOGUE, locate
from pliant.spatial import Array


@dataclass(frozen=True)
class Tool:
    """A rigid tool on a robot's flange.

    The inertia is that of a uniform rod from the flange along its z axis; the contact frame sits at the end.
    """

    length: float = 0.20
    """m along the flange's z axis to the contact frame"""
    mass: float = 0.4
    """kg"""
    radius: float = 0.02
    """m of the rod"""
    parent: str = "flange"
    """frame that carries the tool"""
    frame: str = "tool"
    """name of the new contact frame, axes parallel to the parent's"""


@dataclass(frozen=True)
class Robot:
    """A robot with 1-degree-of-freedom joints on a fixed base. Immutable: the `with_…` methods return another one.

    Everything that computes makes its own `pin.Data` (`robot.model.createData()`), so one robot serves many threads.
    """

    name: str
    model: pin.Model
    """kinematics and inertia; joint damping and friction play no part in its bias"""
    visual: pin.GeometryModel | None
    """shapes to draw; None if the meshes of the file could not be found"""
    home: Array
    """(n,) a comfortable configuration, rad"""
    source: str = ""
    """file that it was read from"""
    contact_radius: Mapping[str, float] = field(default_factory=dict)
    """frame → radius in m of the sphere with which that frame touches things"""

    @staticmethod
    def load(
        source: str | Path,
        *,
        locked: Mapping[str, float] | None = None,
        tool: Tool | None = None,
    ) -> Robot:
        """Loads a robot.

        Args:
            source: catalogue name (`pliant list robots`), or path of a URDF or MJCF file.
            locked: joint → angle in rad (or m) at which it is fixed; the bodies behind it keep their inertia.
            tool: a rod with a contact frame at its end.

        Raises:
            RobotError: no such name or file, the file is neither URDF nor MJCF, or a joint is of an unsupported type.
            ConfigError: a locked joint that the robot does not have.
        """
        entry = CATALOGUE.get(str(source))
        path = locate(str(source))
        robot = _read(path, entry.name if entry else path.stem)
        if entry is not None:
            robot = robot._with_catalogue_data(entry.rotor_inertia, entry.home, entry.contact_radius)
        if locked:
            robot = robot.with_locked(locked)
        return robot.with_tool(tool) if tool is not None else robot

    # ------------------------------------------------------------------ what it has

    @property
    def n(self) -> int:
        """Number of actuated joints."""
        return int(self.model.nv)

    @property
    def joint_names(self) -> tuple[str, ...]:
        return tuple(self.model.names)[1:]

    @property
    def frame_names(self) -> tuple[str, ...]:
        return tuple(frame.name for frame in self.model.frames)

    @property
    def torque_limit(self) -> Array:
        """(n,) N·m; infinite where the file gives none."""
        limit = np.array(self.model.upperEffortLimit, dtype=np.float64)
        return np.where(limit > 0.0, limit, np.inf)

    @property
    def velocity_limit(self) -> Array:
        """(n,) rad/s; infinite where the file gives none."""
        limit = np.array(self.model.upperVelocityLimit, dtype=np.float64)
        return np.where(limit > 0.0, limit, np.inf)

    @property
    def position_lower(self) -> Array:
        """(n,) rad."""
        return np.array(self.model.lowerPositionLimit, dtype=np.float64)

    @property
    def position_upper(self) -> Array:
        """(n,) rad."""
        return np.array(self.model.upperPositionLimit, dtype=np.float64)

    @property
    def armature(self) -> Array:
        """(n,) rotor inertia seen at the joint, kg m²; part of the mass matrix."""
        return np.array(self.model.armature, dtype=np.float64)

    def frame_id(self, name: str) -> int:
        """Index of a frame. Raises RobotError, with the frames there are, if it does not exist."""
        if not self.model.existFrame(name):
            raise RobotError(f"robot {self.name!r} has no frame {name!r}; {options(self.frame_names, name)}")
        return int(self.model.getFrameId(name))

    def joint_index(self, name: str) -> int:
        """Index of a joint in q and v. Raises RobotError, with the joints there are, if it does not exist."""
        if name not in self.joint_names:
            raise RobotError(f"robot {self.name!r} has no joint {name!r}; {options(self.joint_names, name)}")
        return self.joint_names.index(name)

    def carries(self, frame: str, other: str) -> bool:
        """Whether `other` is `frame` itself or hangs on it: a sensor at `frame` feels what touches `other`."""
        wanted, at = self.frame_id(frame), self.frame_id(other)
        while at != wanted:
            above = int(self.model.frames[at].parentFrame)
            if above == at:
                return False
            at = above
        return True

    def vector(self, value: npt.ArrayLike, what: str) -> Array:
        """Checks a joint vector.

        Args:
            value: (n,) numbers.
            what: what the value is, for the error.

        Raises:
            ShapeError: another number of entries than the robot has joints.
            SignalError: an entry is not finite.
        """
        array = np.asarray(value, dtype=np.float64)
        if array.shape != (self.n,):
            raise ShapeError(f"{what} must have {self.n} entries for robot {self.name!r}, got shape {array.shape}")
        if not np.isfinite(array).all():
            raise SignalError(f"{what} must be finite, got {array.tolist()}")
        return array

    # ------------------------------------------------------------------ small kinematics, for setting up

    def placement(self, q: npt.ArrayLike, frame: str) -> tuple[Array, Array]:
        """Position (3,) m and R_world_frame (3, 3) of a frame at q (n,). Allocates: not for control loops."""
        data = self.model.createData()
        pin.framesForwardKinematics(self.model, data, self.vector(q, "q"))
        pose = data.oMf[self.frame_id(frame)]
        return np.array(pose.translation), np.array(pose.rotation)

    # ------------------------------------------------------------------ other robots made from it

    def with_locked(self, joints: Mapping[str, float]) -> Robot:
        """The robot with some joints fixed at given angles (rad or m)."""
        for name, value in joints.items():
            if name not in self.joint_names:
                raise ConfigError(
                    f"robot {self.name!r} has no joint {name!r} to lock; {options(self.joint_names, name)}"
                )
            if not np.isfinite(value):
                raise ConfigError(f"joint {name!r} must be locked at a finite angle, got {value}")
        if len(joints) >= self.n:
            raise ConfigError(f"robot {self.name!r} has {self.n} joints, locking {len(joints)} leaves none to move")
        q = np.array(self.home)
        for name, value in joints.items():
            q[self.joint_index(name)] = value
        ids = [self.model.getJointId(name) for name in joints]
        if self.visual is None:
            model, visual = pin.buildReducedModel(self.model, ids, q), None
        else:
            model, visual = pin.buildReducedModel(self.model, self.visual, ids, q)
        keep = [i for i, name in enumerate(self.joint_names) if name not in joints]
        return replace(self, model=model, visual=visual, home=self.home[keep])

    def with_frame(
        self, name: str, parent: str, offset: npt.ArrayLike = (0.0, 0.0, 0.0), radius: float | None = None
    ) -> Robot:
        """The robot with one more frame.

        Args:
            name: of the new frame.
            parent: frame that carries it; the axes are parallel.
            offset: (3,) m in the parent's axes.
            radius: m of a contact sphere at the frame; None for no contact.
        """
        if self.model.existFrame(name):
            raise RobotError(f"robot {self.name!r} already has a frame {name!r}: choose another name")
        carrier = self.model.frames[self.frame_id(parent)]
        model = self.model.copy()
        placement = carrier.placement * pin.SE3(np.eye(3), np.asarray(offset, dtype=np.float64))
        model.addFrame(pin.Frame(name, carrier.parentJoint, self.frame_id(parent), placement, pin.FrameType.OP_FRAME))
        radii = dict(self.contact_radius) | ({name: radius} if radius is not None else {})
        return replace(self, model=model, contact_radius=radii)

    def with_contact(self, frame: str, radius: float) -> Robot:
        """The robot with a contact sphere of a radius in m around a frame."""
        self.frame_id(frame)
        if not radius > 0.0:
            raise ConfigError(f"the contact radius of frame {frame!r} must be above zero, got {radius}")
        return replace(self, contact_radius=dict(self.contact_radius) | {frame: radius})

    def with_tool(self, tool: Tool) -> Robot:
        """The robot with a rod on its flange; adds its inertia and its contact frame."""
        if not (tool.length > 0.0 and tool.mass >= 0.0 and tool.radius > 0.0):
            raise ConfigError(f"a tool needs length > 0, mass >= 0 and radius > 0, got {tool}")
        robot = self.with_frame(tool.frame, tool.parent, (0.0, 0.0, tool.length))
        carrier = robot.model.frames[robot.frame_id(tool.parent)]
        middle = carrier.placement * pin.SE3(np.eye(3), np.array([0.0, 0.0, tool.length / 2]))
        model = robot.model
        if tool.mass > 0.0:
            rod = pin.Inertia.FromCylinder(tool.mass, tool.radius, tool.length)
            model.appendBodyToJoint(carrier.parentJoint, rod, middle)
        visual = _with_rod(robot.visual, carrier, robot.frame_id(tool.parent), middle, tool)
        return replace(robot, model=model, visual=visual)

    def _with_catalogue_data(self, rotor_inertia: float, home: tuple[float, ...], radii: Mapping[str, float]) -> Robot:
        self.model.armature = np.full(self.n, rotor_inertia)
        start = np.array(home, dtype=np.float64) if home else self.home
        return replace(self, home=start, contact_radius=dict(radii))


def _with_rod(
    visual: pin.GeometryModel | None, carrier: pin.Frame, frame: int, middle: pin.SE3, tool: Tool
) -> pin.GeometryModel | None:
    import coal

    if visual is None:
        return None
    shown = pin.GeometryModel(visual)
    # With its frame: pinocchio looks it up when joints are locked, and reads past the end without one.
    cylinder = coal.Cylinder(tool.radius, tool.length)
    rod = pin.GeometryObject(f"{tool.frame}_rod", carrier.parentJoint, frame, middle, cylinder)
    rod.meshColor = np.array([0.75, 0.77, 0.80, 1.0])
    shown.addGeometryObject(rod)
    return shown


def _read(path: Path, name: str) -> Robot:
    root = _root_tag(path)
    try:
        if root == "robot":
            model = pin.buildModelFromUrdf(str(path))
        elif root == "mujoco":
            model = pin.buildModelFromMJCF(str(path))
        else:
            raise RobotError(f"{path} must be a URDF (<robot>) or an MJCF (<mujoco>), its root element is <{root}>")
    except (ValueError, RuntimeError, IndexError) as error:
        raise RobotError(f"{path} could not be read as a robot: {str(error).strip().splitlines()[-1]}") from error
    for joint, joint_name in zip(list(model.joints)[1:], list(model.names)[1:], strict=True):
        if joint.nq != 1 or joint.nv != 1:
            kind = joint.shortname()
            if kind.startswith("JointModelRUB"):
                raise RobotError(
                    f"{path}: joint {joint_name!r} is continuous; give it limits (type 'revolute'): every joint needs"
                    " one angle"
                )
            raise RobotError(
                f"{path}: joint {joint_name!r} is of type {kind}; only revolute and prismatic joints are supported"
            )
    if model.nv == 0:
        raise RobotError(f"{path} has no joint that moves")
    lower, upper = np.array(model.lowerPositionLimit), np.array(model.upperPositionLimit)
    finite = np.isfinite(lower) & np.isfinite(upper) & (upper - lower < 1e3)
    home = np.where(finite, np.clip(0.0, lower, upper), 0.0)
    return Robot(name=name, model=model, visual=_read_visual(model, path, root), home=home, source=str(path))


def _root_tag(path: Path) -> str:
    try:
        return str(ElementTree.parse(path).getroot().tag)
    except ElementTree.ParseError as error:
        raise RobotError(f"{path} is not XML ({error}); a robot file is a URDF or an MJCF") from error
    except OSError as error:
        raise RobotError(f"{path} cannot be read: {error.strerror}") from error


def _read_visual(model: pin.Model, path: Path, root: str) -> pin.GeometryModel | None:
    folders = [str(folder) for folder in path.resolve().parents]
    try:
        if root == "robot":
            return pin.buildGeomFromUrdf(model, str(path), pin.GeometryType.VISUAL, package_dirs=folders)
        return pin.buildGeomFromMJCF(model, str(path), pin.GeometryType.VISUAL)
    except (ValueError, RuntimeError):
        return None  # meshes that are not there: the robot still works, drawn as a stick figure
