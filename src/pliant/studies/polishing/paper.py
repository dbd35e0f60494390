"""The numbers that [FFMPC] prints: Tables II and III (simulation), IV (difference), V to VII and Fig. 4 (robot)."""

from __future__ import annotations

from collections.abc import Mapping

STOCK = ("classical-mpc", "torque-feedback-mpc", "force-feedback-mpc")
"""the three controllers that the paper compares, in its order"""

SIMULATION: Mapping[bool, Mapping[str, tuple[float, float, float]]] = {
    False: {
        "E_P": (5.75, 2.44, 4.59),
        "E_λ": (25.52, 33.98, 10.55),
        "λ_max": (59.36, 105.57, 110.95),
        "t_break": (0.51, 32.75, 0.00),
    },
    True: {
        "E_P": (7.94, 3.87, 3.07),
        "E_λ": (15.21, 12.44, 2.04),
        "λ_max": (185.75, 211.00, 111.97),
        "t_break": (0.00, 0.00, 0.00),
    },
}
"""with the drives' torque loop → metric → number per controller; mm, N, N, %"""

DIFFERENCE: Mapping[str, tuple[float, float, float]] = {"E_λ": (10.31, 21.55, 8.51), "E_τ": (2.24, 2.20, 1.95)}
"""metric → without minus with the torque loop, N and N·m (Table IV)"""

ROBOT: Mapping[str, Mapping[str, tuple[float, float, float]]] = {
    "square": {"E_λ": (2.76, 2.70, 2.16)},
    "slow": {"E_λ": (9.31, 4.28, 1.70), "E_P": (6.48, 3.23, 3.10)},
    "slow-tilted": {"E_λ": (9.49, 9.67, 2.12), "E_P": (7.04, 3.37, 3.34)},
    "fast-tilted": {"E_λ": (9.00, 11.40, 1.84), "E_P": (10.85, 5.41, 5.29)},
}
"""case → metric → mean on the robot per controller, N and mm"""


def paper_number(case: str, controller: str, metric: str, torque_loop: bool) -> float | None:
    """What the paper prints for a run like this; None where it prints nothing."""
    if controller not in STOCK:
        return None
    table = SIMULATION[torque_loop] if case.startswith("tables-2-3-4") else ROBOT.get(case, {})
    numbers = table.get(metric)
    return None if numbers is None else numbers[STOCK.index(controller)]
