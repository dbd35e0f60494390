"""The cases of the haptic study: who does what when, and what it should come to.

The foot is a sphere of 20 mm radius: a target at height z + 0.02 m touches a surface at height z.
"""

from __future__ import annotations

from collections.abc import Mapping

from pliant.experiments.case import Case
from pliant.studies.haptic.cases_ball import BALL_CASES
from pliant.studies.haptic.cases_box import BOX_CASES
from pliant.studies.haptic.cases_floor import FLOOR_CASES
from pliant.studies.haptic.cases_online import ONLINE_CASES
from pliant.studies.haptic.cases_stream import STREAM_CASES
from pliant.studies.haptic.config import HapticCaseConfig

CASES: Mapping[str, Case[HapticCaseConfig]] = {
    case.config.case: case for case in (*FLOOR_CASES, *BOX_CASES, *BALL_CASES, *ONLINE_CASES, *STREAM_CASES)
}
"""by name; the first is what `pliant run haptic` does"""
