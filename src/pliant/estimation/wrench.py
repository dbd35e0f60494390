"""Contact wrenches and contact states from force/torque sensors."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from pliant._estimation import Tree, WrenchStage
from pliant.errors import ConfigError
from pliant.estimation.carried_mass import CarriedMass
from pliant.estimation.chain import ChainedEstimator
from pliant.estimation.joint_acceleration import JointAcceleration
from pliant.estimation.tare import Tare
from pliant.rigid_body import tree_of
from pliant.robot import Robot


@dataclass(frozen=True)
class TouchThresholds:
    """Contact detection of a frame: hysteresis on the magnitude of its contact force."""

    begin: float = 1.0
    """N above which contact begins"""
    end: float = 0.5
    """N below which it ends"""
    linger: float = 5e-3
    """s for which the force must stay below `end`"""

    def __post_init__(self) -> None:
        if not 0.0 <= self.end <= self.begin or self.linger < 0.0:
            raise ConfigError(f"touch thresholds need 0 <= end <= begin and linger >= 0, got {self}")


class WrenchEstimator(ChainedEstimator):
    """Passes joint signals on, converts sensor readings into contact wrenches in world axes, and detects contacts.

    Weight and inertia of the load are subtracted from the reading; the joint accelerations come from
    differences of v, whose error `JointAcceleration` states.

    Args:
        robot: gives the sensors' motion.
        carried: sensor frame → what it carries; frames that are not named carry nothing.
        thresholds: thresholds of the contact detection.
        velocity_gain: α of v ← v + α (v_measured − v); 1 filters nothing. The accelerations do not use it.
        contact_frames: sensor frame → contact frame beyond it; wrench and contact are given at that frame and under its
            name. Other sensors use their own frame.
        acceleration: how joint accelerations are found.
        tare: how unknown loads of the sensors are tared at the start; None: no taring.

    Raises:
        ConfigError: the gain is not within (0, 1], a contact frame that the sensor cannot feel or that has two sensors.
        RobotError: a frame that the robot does not have.
    """

    def __init__(
        self,
        robot: Robot,
        carried: Mapping[str, CarriedMass] | None = None,
        thresholds: TouchThresholds | None = None,
        *,
        velocity_gain: float = 1.0,
        contact_frames: Mapping[str, str] | None = None,
        acceleration: JointAcceleration | None = None,
        tare: Tare | None = None,
    ) -> None:
        self.robot, self.carried = robot, dict(carried or {})
        self.thresholds, self.velocity_gain = thresholds or TouchThresholds(), velocity_gain
        self.contact_frames = dict(contact_frames or {})
        self.acceleration, self.tare = acceleration or JointAcceleration(), tare
        for name in self.carried:
            robot.frame_id(name)
        _check_contact_frames(robot, self.contact_frames)
        stage = wrench_stage(
            tree_of(robot.model),
            velocity_gain,
            self.thresholds,
            self.carried,
            self.contact_frames,
            self.acceleration,
            tare,
        )
        super().__init__(stage, None, frozenset(), named=robot)


def wrench_stage(
    tree: Tree | None,
    velocity_gain: float,
    thresholds: TouchThresholds | None = None,
    carried: Mapping[str, CarriedMass] | None = None,
    contact_frames: Mapping[str, str] | None = None,
    acceleration: JointAcceleration | None = None,
    tare: Tare | None = None,
) -> WrenchStage:
    """The first stage of a chain; without a tree it looks at no wrench. Arguments as of `WrenchEstimator`.

    Raises:
        ConfigError: the gain is not within (0, 1].
    """
    if not 0.0 < velocity_gain <= 1.0:
        raise ConfigError(f"velocity_gain must lie within (0, 1], got {velocity_gain}")
    touch = thresholds or TouchThresholds()
    return WrenchStage(
        robot=tree,
        velocity_gain=velocity_gain,
        begin=touch.begin,
        end=touch.end,
        linger=touch.linger,
        carried={sensor: load.row for sensor, load in (carried or {}).items()},
        contact_frames=contact_frames or {},
        acceleration_cutoff=(acceleration or JointAcceleration()).cutoff,
        tare=None if tare is None else (tare.duration, tare.kind == "weight", tare.still),
    )


def _check_contact_frames(robot: Robot, frames: Mapping[str, str]) -> None:
    for sensor, touching in frames.items():
        if not robot.carries(sensor, touching):
            raise ConfigError(
                f"the sensor at frame {sensor!r} cannot feel what touches frame {touching!r}: that frame must be the"
                " sensor's own or hang on it"
            )
    if len(set(frames.values())) < len(frames):
        raise ConfigError(f"two sensors must not give the wrench of one contact frame, got {dict(frames)}")
