"""The haptic study: [HapFIC] Tiseo et al. 2021."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from pliant.experiments.base import Experiment, Study
from pliant.studies.haptic import draw
from pliant.studies.haptic.build import build
from pliant.studies.haptic.cases import CASES
from pliant.studies.haptic.config import HapticCaseConfig
from pliant.studies.haptic.measure import measure
from pliant.telemetry.log import Log
from pliant.telemetry.summary import Metric


class HapticStudy(Study[HapticCaseConfig]):
    """A leg that presses, slides, tips, follows and lets go, with a desired force and no model of what it touches."""

    name = "haptic"
    title = "haptic exploration with a three-joint leg (Tiseo et al. 2021)"
    cases = CASES

    def build(self, config: HapticCaseConfig) -> Experiment:
        return build(config)

    def verdict(self, config: HapticCaseConfig, metrics: Sequence[Metric]) -> str | None:
        """A random scene in which a bound is exceeded is a failed run; the failure has the command that repeats it."""
        missed = [f"{m.name} {m.value:.3g} {m.unit}".strip() for m in metrics if m.met is False]
        if not config.random or not missed:
            return None
        return f"{'; '.join(missed)} (replay: pliant run haptic --case {config.case} --seed {config.seed})"

    def metrics(self, config: HapticCaseConfig, log: Log) -> tuple[Metric, ...]:
        return measure(config, log)

    def figures(self, config: HapticCaseConfig, experiment: Experiment, log: Log, folder: Path) -> list[Path]:
        return draw.run_figures(config, experiment, log, folder)


STUDY = HapticStudy()
