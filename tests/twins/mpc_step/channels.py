"""Channels of one solve."""

from __future__ import annotations

import numpy as np

from pliant import _mpc
from pliant.mpc.diagnostics import STATUS_CODES
from pliant.spatial import Array


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
