"""The rows that the cases of the haptic study have."""

from __future__ import annotations

from typing import Any

from pliant.experiments.case import Case, Row, once, seeded
from pliant.studies.haptic.config import HapticCaseConfig

PRINTED = Row(controller="haptic-paper")
PROFILE_PRINTED = Row("profile as printed", changes={"impedance": {"profile": "tanh-printed"}}, shown=False)
"""[HapFIC] eq. 4 with S = 0.1353, under pliant's law"""


def plain(config: HapticCaseConfig, **more: Any) -> Case[HapticCaseConfig]:
    """Pliant's exploration and the printed one, once each. The bounds stand in the checks."""
    return Case(config, (Row(), PRINTED), once, **more)


def drawn(config: HapticCaseConfig, seeds: int) -> Case[HapticCaseConfig]:
    """Both on several seeds; where things change online, also without the offset's return."""
    held = [Row("no reset", changes={"exploration": {"reset": False}})] if config.online is not None else []
    return Case(config, (Row(), *held, PRINTED), seeded(seeds))
