"""The robots that can be loaded by name, with data that their files lack. Limits are those of the named source."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from pliant.robots.known_rotors import IDENTIFIED_FR3, RULE, Rotors


@dataclass(frozen=True)
class CatalogueEntry:
    """A robot that can be loaded by name."""

    name: str
    description: str
    file: str
    """of pliant's own robots: URDF in this folder; of example-robot-data: path below its robots; of
    robot_descriptions: name of a module"""
    package: Literal["pliant", "example-robot-data", "robot_descriptions"] = "pliant"
    rotors: Rotors | None = None
    """the motors' inertia, of all joints of the file; None: that of the file"""
    rotors_from: str = RULE
    """its source"""
    home: tuple[float, ...] = ()
    """rad, all joints of the file; empty: that of the file, or searched"""
    contact_radius: Mapping[str, float] = field(default_factory=dict)
    """frame → m"""
    flange: str = ""
    """frame of the file that is the flange; empty: the frame `flange`, or the end of the arm"""
    locked: Mapping[str, float] = field(default_factory=dict)
    """joint → rad or m: joints that are locked by default, such as fingers"""

    @property
    def own(self) -> bool:
        """Whether the file is part of pliant."""
        return self.package == "pliant"


_QUARTER = math.pi / 2
_UR_HOME = (0.0, -_QUARTER, _QUARTER, -_QUARTER, -_QUARTER, 0.0)
_DATA = "example-robot-data"

_OWN = (
    CatalogueEntry(
        "lwr4",
        "KUKA LWR 4+, 7 joints; kinematics, torques and speeds of the arm. Its dynamics are assumed: uniform cylinders"
        " of 2.7 kg (four), 1.7, 1.6 and 0.3 kg, rotor inertia 0.05 kg m²",
        "lwr4.urdf",
        rotors=0.05,
        rotors_from="assumed",
        home=(0.0, 0.6, 0.0, -1.4, 0.0, 1.0, 0.0),
    ),
    CatalogueEntry(
        "iiwa7",
        "KUKA LBR iiwa 7 R800, 7 joints; inertias as published with lbr_description, limits of the data sheet, assumed"
        " rotors",
        "iiwa7.urdf",
        rotors="assumed",
        home=(0.0, 1.0472, 0.0, -1.13446, 0.2, 0.7854, 0.0),
    ),
    CatalogueEntry(
        "iiwa14",
        "KUKA LBR iiwa 14 R820, 7 joints; identified inertial parameters, assumed rotors",
        "iiwa14.urdf",
        rotors="assumed",
        home=(0.0, 1.0472, 0.0, -1.13446, 0.2, 0.7854, 0.0),
    ),
    CatalogueEntry(
        "panda",
        "Franka Emika Panda without a hand, 7 joints; kinematics and limits of the maker's documentation, inertial"
        " parameters as published with franka_ros, rotors as identified for the FR3",
        "panda.urdf",
        rotors=IDENTIFIED_FR3,
        rotors_from="identified for the FR3 (mujoco_menagerie), assumed to have the same drives",
        home=(0.0, -math.pi / 4, 0.0, -3 * math.pi / 4, 0.0, _QUARTER, math.pi / 4),
    ),
    CatalogueEntry(
        "ur5e",
        "Universal Robots UR5e, 6 joints; kinematics, masses, inertia, torques and speeds as the maker publishes them;"
        " the elbow at ±180°, its range beside the upper arm; assumed rotors",
        "ur5e.urdf",
        rotors="assumed",
        home=_UR_HOME,
    ),
    CatalogueEntry(
        "leg3",
        "three-joint leg (hip roll, hip pitch, knee) of uniform 1 kg rods, base 0.5 m above the floor",
        "leg3.urdf",
        home=(0.0, 0.7, -1.4),
        contact_radius={"foot": 0.02},
    ),
)

_DATA_ENTRIES = (
    *(
        CatalogueEntry(
            f"ur{size}",
            f"Universal Robots UR{size}, 6 joints; everything from its URDF but assumed rotors",
            f"ur_description/urdf/ur{size}_robot.urdf",
            _DATA,
            rotors="assumed",
            home=_UR_HOME,
            flange="tool0",
        )
        for size in (3, 5, 10)
    ),
    CatalogueEntry(
        "xarm7",
        "UFACTORY xArm 7, 7 joints; everything from its URDF but assumed rotors",
        "xarm_description/urdf/xarm7.urdf",
        _DATA,
        rotors="assumed",
        home=(0.0, -0.5, 0.0, 1.0, 0.0, 1.5, 0.0),
        flange="link_eef",
    ),
    CatalogueEntry(
        "z1",
        "Unitree Z1, 6 joints, its gripper locked; everything from its URDF but assumed rotors",
        "z1_description/urdf/z1.urdf",
        _DATA,
        rotors="assumed",
        home=(0.0, 1.5, -1.2, 1.2, 0.0, 0.0, 0.0),
        flange="gripperStator",
        locked={"jointGripper": 0.0},
    ),
    CatalogueEntry(
        "jaco2",
        "Kinova JACO 2 with 6 joints, three of them continuous; everything from its URDF but assumed rotors",
        "kinova_description/robots/kinova.urdf",
        _DATA,
        rotors="assumed",
        home=(1.91, 1.25, 2.22, -1.9, 1.13, -2.25),
        flange="j2s6s200_end_effector",
    ),
    CatalogueEntry(
        "anymal",
        "ANYmal B quadruped on a fixed base, 12 joints; everything from its URDF",
        "anymal_b_simple_description/robots/anymal.urdf",
        _DATA,
    ),
)

_MODULE_ENTRIES = (
    CatalogueEntry(
        "fr3",
        "Franka Research 3, 7 joints; everything from its MJCF, which robot_descriptions downloads",
        "fr3_mj_description",
        "robot_descriptions",
    ),
    CatalogueEntry(
        "gen3",
        "Kinova Gen3, 7 joints; everything from its MJCF, which robot_descriptions downloads",
        "gen3_mj_description",
        "robot_descriptions",
    ),
)

CATALOGUE: Mapping[str, CatalogueEntry] = {entry.name: entry for entry in (*_OWN, *_DATA_ENTRIES, *_MODULE_ENTRIES)}
"""name → entry"""


def robots() -> Mapping[str, CatalogueEntry]:
    """Name → every robot of the catalogue."""
    return CATALOGUE
