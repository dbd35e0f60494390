"""Inertia of motors that is known, and the rule for the others; apart, so that the catalogue is read without a robot's
libraries."""

from __future__ import annotations

from typing import Literal

Rotors = float | tuple[float, ...] | Literal["assumed"]
"""kg m² at every joint or at each of all joints of the file; "assumed": from their torque limits"""

IDENTIFIED_FR3 = (0.195, 0.195, 0.195, 0.195, 0.074, 0.074, 0.074)
"""kg m², Franka Research 3, identified in torque control: `franka_fr3/fr3.xml` and its CHANGELOG (2025-04-25) of
mujoco_menagerie"""
PER_ROOT_TORQUE = 0.021
"""kg m² / √(N·m): √τ_max times it is 0.196 and 0.073 kg m² for the drives of 87 and 12 N·m of the FR3"""
RULE = f"assumed, {PER_ROOT_TORQUE:g} √(torque limit), the rule that fits the identified drives of the FR3"
