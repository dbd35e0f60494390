"""The attractor as it was without a passivity account: the control of the laws that the account must keep."""

from __future__ import annotations

from pliant.controllers.attractor import Attractor, AttractorState
from pliant.controllers.passivity_account import ErrorMotion
from pliant.controllers.profiles import ForceProfile
from pliant.spatial import Array


class BlendAlone(Attractor):
    """Phases, capped law and blend, sampled, and nothing that books what they let out."""

    def step(
        self, profile: ForceProfile, error: Array, state: AttractorState, motion: ErrorMotion | None = None
    ) -> tuple[Array, AttractorState]:
        return self.wish(profile, error, state)
