"""What the best controller of pliant is to reach, case by case; the others are not judged."""

from __future__ import annotations

from collections.abc import Mapping

from pliant.studies.polishing.config import PolishingConfig

BEST = "offset-free-mpc"

_ROBUST: Mapping[str, Mapping[str, float]] = {
    "friction 0.5": {"E_λ": 1.3, "E_P": 1.2},
    "6 rad/s": {"E_λ": 1.3, "E_P": 1.2},
    "table 3e3 N/m": {"E_λ": 1.5},
    "table 3e4 N/m": {"E_λ": 1.5},
    "table 1e5 N/m": {"E_λ": 1.5},
    "tool 0.5 kg heavier": {"E_λ": 0.8},
    "noise × 3": {"E_λ": 1.5},
    "pushed": {"E_λ": 1.6},
}


def targets_of(config: PolishingConfig) -> Mapping[str, float]:
    """Metric → upper bound, in the metric's unit."""
    if config.case == "ideal" and config.controller == "force-feedback-mpc" and config.preset == "perfect":
        return {"E_λ": 0.5, "E_P": 1.0, "t_break": 0.0}
    if config.controller == "force-feedback-mpc" and config.case == "tables-2-3-4":
        return {"E_λ": 4.0} if config.imperfections.torque_loop.gain_p else {}
    if config.controller != BEST:
        return {}
    if config.case == "tables-2-3-4-delayed" and config.variant in ("PID", "no PID"):
        bound = 0.5 if config.variant == "PID" else 0.6
        return {"E_λ": bound, "E_P": bound, "λ_max": 58.0, "t_break": 0.0, "first contact peak": 30.0}
    return _ROBUST.get(config.variant, {}) if config.case == "robustness" else {}
