"""Diagnostics of the predictive controllers: fixed channel names, the same in every command."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

STATUS_CODES: Mapping[str, int] = {
    "converged": 0,
    "max_iterations": 1,
    "time_budget": 2,
    "line_search": 3,
    "not_positive_definite": 4,
    "nan": 5,
}
"""Code of channel mpc/status"""

SOURCE_CODES: Mapping[str, int] = {"plan": 0, "old plan": 1, "gravity and damping": 2}
"""Code of channel mpc/source: the source of the torque"""


class DiagnosticChannel(NamedTuple):
    """Unit and shape of a diagnostic."""

    unit: str


_UNITS = {
    "mpc/iterations": "1",
    "mpc/kkt": "1",
    "mpc/cost": "1",
    "mpc/gap": "1",
    "mpc/violation": "N·m, N",
    "mpc/status": "1",
    "mpc/source": "1",
    "mpc/failures": "1",
    "mpc/deadline_missed": "1",
    "mpc/contact_nodes": "1",
    "mpc/disturbance": "N·m",
    "mpc/force_shift": "N",
    "mpc/predicted_path": "m",
    "mpc/predicted_force": "N, N·m",
}

CHANNELS: Mapping[str, DiagnosticChannel] = {name: DiagnosticChannel(unit) for name, unit in _UNITS.items()}
"""name → what it is"""
