"""The cases of the study, each with its rows, the paper's numbers, targets, tables and figures."""

from __future__ import annotations

from collections.abc import Mapping

from pliant.experiments.case import Case
from pliant.studies.polishing.cases_beyond import BEYOND_CASES
from pliant.studies.polishing.cases_open import OPEN_CASES
from pliant.studies.polishing.cases_sweeps import SWEEP_CASES
from pliant.studies.polishing.cases_tables import TABLE_CASES
from pliant.studies.polishing.config import PolishingConfig

CASES: Mapping[str, Case[PolishingConfig]] = {
    case.config.case: case for case in (*TABLE_CASES, *SWEEP_CASES, *OPEN_CASES, *BEYOND_CASES)
}
"""by name; the first is what `pliant run polishing` does"""
