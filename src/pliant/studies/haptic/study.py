"""The haptic study: [HapFIC] Tiseo et al. 2021."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from pliant.experiments.base import Experiment, Result, Study
from pliant.studies.haptic import draw
from pliant.studies.haptic.build import build
from pliant.studies.haptic.cases import CASES
from pliant.studies.haptic.config import HapticConfig
from pliant.studies.haptic.delays import delay_runs
from pliant.studies.haptic.measure import measure
from pliant.studies.haptic.parameters import parameter_runs
from pliant.telemetry.log import Log
from pliant.telemetry.summary import Metric

_RANDOM_SCENES = 20
_ONLINE_SEEDS = 3


class HapticStudy(Study[HapticConfig]):
    """A leg that presses, slides, tips, follows and lets go, with a desired force and no model of what it touches."""

    name = "haptic"
    title = "haptic exploration with a three-joint leg (Tiseo et al. 2021)"
    cases = CASES

    def build(self, config: HapticConfig) -> Experiment:
        return build(config)

    def runs(self, case: str, seeds: int | None = None) -> Sequence[HapticConfig]:
        config = self.case(case)
        if case == "delay":
            return [config, *delay_runs(config)]
        if case == "parameters":
            return [config, *parameter_runs(config)]
        count = 1
        if config.random or config.online is not None:
            count = seeds or (_RANDOM_SCENES if config.random else _ONLINE_SEEDS)
        seeded = [config.model_copy(update={"seed": config.seed + i}) for i in range(count)]
        printed = [run.model_copy(update={"controller": "haptic-paper"}) for run in seeded]
        if config.online is None:
            return [*seeded, *printed]
        held = config.exploration.model_copy(update={"reset": False})
        without = [run.model_copy(update={"exploration": held, "variant": "no reset"}) for run in seeded]
        return [*seeded, *without, *printed]

    def verdict(self, config: HapticConfig, metrics: Sequence[Metric]) -> str | None:
        """A random scene in which a bound broke is a failed run: it names the seed that replays it."""
        missed = [f"{m.name} {m.value:.3g} {m.unit}".strip() for m in metrics if m.met is False]
        if not config.random or not missed:
            return None
        return f"{'; '.join(missed)} (replay: pliant run haptic --case {config.case} --seed {config.seed})"

    def metrics(self, config: HapticConfig, log: Log) -> tuple[Metric, ...]:
        return measure(config, log)

    def figures(self, config: HapticConfig, experiment: Experiment, log: Log, folder: Path) -> list[Path]:
        return draw.run_figures(config, experiment, log, folder)

    def summary_figures(self, results: Sequence[Result], folder: Path) -> list[Path]:
        return draw.summary_figures(results, folder)


STUDY = HapticStudy()
