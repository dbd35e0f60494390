"""A robot: its rigid-body model, frames, limits and visual shapes, from a URDF, an MJCF or a catalogue name."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from pliant.errors import ConfigError, RobotError, ShapeError, SignalError, UnknownFrameError, options
from pliant.robots.assembly import assemble
from pliant.robots.known_rotors import Rotors
from pliant.robots.locking import lock
from pliant.robots.tool import Tool as Tool
from pliant.robots.tool import ToolBody, with_rod
from pliant.spatial import Array, is_rotation

_WORLD = "universe"
"""pinocchio's name of what is not part of the robot"""


@dataclass(frozen=True)
class Robot:
    """A robot with 1-degree-of-freedom joints on a fixed base. Immutable: the `with_…` methods return another one.

    Everything that computes makes its own `pin.Data` (`robot.model.createData()`), so one robot serves many threads.
    """

    name: str
    model: pin.Model
    """kinematics and inertia, without joint damping and friction"""
    visual: pin.GeometryModel | None
    """shapes to draw; None if the meshes of the file could not be found"""
    home: Array
    """(n,) home configuration, rad"""
    source: str = ""
    """file that it was read from"""
    contact_radius: Mapping[str, float] = field(default_factory=dict)
    """frame → radius in m of its contact sphere"""
    contact_bodies: Mapping[str, ToolBody] = field(default_factory=dict)
    """frame → cylinder or box that makes contact at several points"""
    home_from: str = "given"
    """where the home comes from"""
    rotors_from: str = ""
    """source of the motors' inertia; empty: none is given"""
    notes: tuple[str, ...] = ()
    """sentences about what was assumed, changed or left out when the file was read"""
    faults: tuple[str, ...] = ()
    """why the robot cannot be simulated; its kinematics can be used all the same"""

    @staticmethod
    def load(
        source: str | Path,
        *,
        locked: Mapping[str, float] | None = None,
        home: npt.ArrayLike | str | None = None,
        tool: Tool | None = None,
        rotor_inertia: Rotors | None = None,
    ) -> Robot:
        """Loads a robot.

        A serial arm gets the frames `flange` (its last link) and `elbow` (the joint that splits its length most evenly)
        where the file has none of that name; `notes` says so, and what else was assumed.

        Args:
            source: catalogue name (`pliant list robots`), or path of a URDF or MJCF file.
            locked: joint → angle in rad (or m) at which it is fixed; the bodies behind it keep their inertia. Beside
                those that the catalogue locks (a gripper's); None: only those; empty: none. A ball, free, floating or
                planar joint stays where the file puts it.
            home: (n,) rad or m for the joints that move, or the name of a keyframe. None: that of the catalogue, the
                keyframe `home`, the first keyframe, or a bent pose that is searched for.
            tool: a rod with a contact frame at its end.
            rotor_inertia: kg m² of the motors as every joint feels it, or one number for each joint of the file, or
                "assumed": from the torque limits. None: that of the catalogue, or of the file (a URDF has none).

        Raises:
            RobotError: no such name or file, or the file holds something that cannot be represented; it is named.
            ConfigError: a locked joint or a keyframe that the robot does not have, or a home outside its limits.
        """
        found = assemble(str(source), locked, home, rotor_inertia)
        robot = Robot(**vars(found))
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
        """Without the world's frame, which is no part of the robot."""
        return tuple(frame.name for frame in self.model.frames if frame.name != _WORLD)

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
        """Index of a frame. Raises UnknownFrameError, with the frames there are, if it does not exist."""
        if name == _WORLD or not self.model.existFrame(name):
            raise UnknownFrameError(f"robot {self.name!r} has no frame {name!r}; {options(self.frame_names, name)}")
        return int(self.model.getFrameId(name))

    def joint_index(self, name: str) -> int:
        """Index of a joint in q and v. Raises RobotError, with the joints there are, if it does not exist."""
        if name not in self.joint_names:
            raise RobotError(f"robot {self.name!r} has no joint {name!r}; {options(self.joint_names, name)}")
        return self.joint_names.index(name)

    def require_masses(self) -> None:
        """Raises RobotError if the robot's masses and inertias are not physically possible."""
        if self.faults:
            raise RobotError(
                f"robot {self.name!r} cannot be simulated: {self.faults[0]}; correct its <inertial> (kinematics work"
                " without it)"
            )

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
            what: name of the value, for the error.

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

    def with_locked(self, joints: Mapping[str, float]) -> Robot:
        """The robot with some joints fixed at given angles (rad or m).

        Raises:
            ConfigError: a joint that it does not have, or all of its joints.
        """
        model, visual, home = lock(self.name, self.model, self.visual, self.home, joints)
        return replace(self, model=model, visual=visual, home=home)

    def with_frame(
        self,
        name: str,
        parent: str,
        offset: npt.ArrayLike = (0.0, 0.0, 0.0),
        radius: float | None = None,
        rotation: npt.ArrayLike | None = None,
    ) -> Robot:
        """The robot with one more frame.

        Args:
            name: of the new frame.
            parent: frame that carries it.
            offset: (3,) m in the parent's axes.
            radius: m of a contact sphere at the frame; None for no contact.
            rotation: R_parent_frame (3, 3); None: the axes are parallel.

        Raises:
            RobotError: the robot has a frame of that name already, or not the parent.
            ConfigError: `rotation` is not a rotation matrix.
        """
        if self.model.existFrame(name):
            raise RobotError(f"robot {self.name!r} already has a frame {name!r}: choose another name")
        carrier = self.model.frames[self.frame_id(parent)]
        model = self.model.copy()
        R = np.eye(3) if rotation is None else np.asarray(rotation, dtype=np.float64)
        if not is_rotation(R):
            raise ConfigError(f"the rotation of frame {name!r} must be a rotation matrix (3, 3), got {R.tolist()}")
        placement = carrier.placement * pin.SE3(R, np.asarray(offset, dtype=np.float64))
        model.addFrame(pin.Frame(name, carrier.parentJoint, self.frame_id(parent), placement, pin.FrameType.OP_FRAME))
        radii = dict(self.contact_radius) | ({name: radius} if radius is not None else {})
        return replace(self, model=model, contact_radius=radii)

    def with_contact(self, frame: str, radius: float) -> Robot:
        """The robot with a contact sphere of a radius in m around a frame."""
        self.frame_id(frame)
        if not radius > 0.0:
            raise ConfigError(f"the contact radius of frame {frame!r} must be above zero, got {radius}")
        return replace(self, contact_radius=dict(self.contact_radius) | {frame: radius})

    def touching_with(self, tool: Tool) -> Robot:
        """The robot, which already has the tool's frame, with the tool's shape as contact shape."""
        bodies = dict(self.contact_bodies) | ({tool.frame: tool.body} if tool.body else {})
        return replace(self, contact_bodies=bodies) if tool.body else self.with_contact(tool.frame, tool.reach)

    def with_tool(self, tool: Tool) -> Robot:
        """The robot with a tool on its flange; adds its inertia, visual shape and contact frame."""
        tool.check()
        robot = self.with_frame(tool.frame, tool.parent, (0.0, 0.0, tool.length))
        carrier = robot.model.frames[robot.frame_id(tool.parent)]
        middle = carrier.placement * pin.SE3(np.eye(3), np.array([0.0, 0.0, tool.length / 2]))
        if tool.mass > 0.0:
            robot.model.appendBodyToJoint(carrier.parentJoint, tool.inertia, middle)
        visual = with_rod(robot.visual, carrier, robot.frame_id(tool.parent), middle, tool)
        return replace(robot, visual=visual)
