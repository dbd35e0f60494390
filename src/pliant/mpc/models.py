"""The prediction models and their properties; other modules use the properties, not the names."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

Kind = Literal["force_feedback", "classical", "torque_feedback", "free", "naive_viscoelastic"]


@dataclass(frozen=True, slots=True)
class PredictiveModel:
    """One of the models of [FFMPC] sections III to V, or without contact."""

    kind: Kind
    force_state: bool = False
    """the contact force is part of the state, and measured"""
    torque_state: bool = False
    """the joint torque is part of the state, measured, and what is sent is interpolated from it"""
    touches: bool = True
    """whether there is contact"""
    rigid: bool = False
    """rigid contact: its force follows from the acceleration"""
    springy: bool = False
    """the contact force follows from deflection and rate, and is not a state"""

    def extra(self, m: int, nu: int) -> int:
        """Entries of the state beside positions and velocities, for m contact forces and nu torques."""
        return m if self.force_state else nu if self.torque_state else 0


MODELS: Mapping[Kind, PredictiveModel] = {
    model.kind: model
    for model in (
        PredictiveModel("force_feedback", force_state=True),
        PredictiveModel("classical", rigid=True),
        PredictiveModel("torque_feedback", torque_state=True, rigid=True),
        PredictiveModel("free", touches=False),
        PredictiveModel("naive_viscoelastic", springy=True),
    )
}
"""kind → properties"""
