"""The haptic study: [HapFIC] Tiseo et al. 2021."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from pliant.studies.base import Experiment, Result, Study
from pliant.studies.haptic import draw
from pliant.studies.haptic.build import build
from pliant.studies.haptic.cases import CASES
from pliant.studies.haptic.config import HapticConfig
from pliant.studies.haptic.measure import measure
from pliant.telemetry.log import Log
from pliant.telemetry.summary import Metric


class HapticStudy(Study[HapticConfig]):
    """A leg that presses, slides, tips, follows and lets go, with a desired force and no model of what it touches."""

    name = "haptic"
    title = "haptic exploration with a three-joint leg (Tiseo et al. 2021)"
    cases = CASES
    controllers = ("haptic", "haptic-paper", "haptic-hold")

    def build(self, config: HapticConfig) -> Experiment:
        return build(config)

    def runs(self, case: str, seeds: int | None = None) -> Sequence[HapticConfig]:
        config = self.case(case)
        return [config, config.model_copy(update={"controller": "haptic-paper"})]

    def metrics(self, config: HapticConfig, log: Log) -> tuple[Metric, ...]:
        return measure(config, log)

    def figures(self, config: HapticConfig, experiment: Experiment, log: Log, folder: Path) -> list[Path]:
        return draw.run_figures(config, experiment, log, folder)

    def summary_figures(self, results: Sequence[Result], folder: Path) -> list[Path]:
        return draw.summary_figures(results, folder)


STUDY = HapticStudy()
