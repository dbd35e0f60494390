"""Diagnostics of the predictive controllers: fixed channel names, the same in every command."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from pliant import _mpc
from pliant.spatial import Array

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
"""Code of channel mpc/source: where the torque came from"""


class DiagnosticChannel(NamedTuple):
    """What a diagnostic is."""

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


def of_solution(
    solution: _mpc.Solution, path: Array, contact_nodes: int, deadline: float | None
) -> dict[str, float | Array]:
    """Channels of one solve.

    Args:
        solution: what the solver returned.
        path: (N+1, 3) m, predicted tool positions.
        contact_nodes: how many nodes of the horizon are in contact.
        deadline: s of wall time a solve may take; None: the log stays free of wall times.
    """
    missed = deadline is not None and solution.solve_time > deadline
    return {
        "mpc/iterations": float(solution.iterations),
        "mpc/kkt": float(solution.kkt),
        "mpc/cost": float(solution.cost),
        "mpc/gap": float(solution.gap),
        "mpc/violation": float(solution.violation),
        "mpc/status": float(STATUS_CODES[solution.status]),
        "mpc/deadline_missed": float(missed),
        "mpc/contact_nodes": float(contact_nodes),
        "mpc/predicted_path": path,
        "mpc/predicted_force": solution.forces,
    }


def of_no_solution(horizon: int, m: int) -> dict[str, float | Array]:
    """The same channels when there was nothing to solve from."""
    return {
        **dict.fromkeys(("mpc/iterations", "mpc/kkt", "mpc/cost", "mpc/gap", "mpc/violation"), 0.0),
        "mpc/status": float(STATUS_CODES["nan"]),
        "mpc/deadline_missed": 0.0,
        "mpc/contact_nodes": 0.0,
        "mpc/predicted_path": np.zeros((horizon + 1, 3)),
        "mpc/predicted_force": np.zeros((horizon, m)),
    }
