"""Result of one run. !!"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from pliant.experiments.base_config import CaseConfig
from pliant.telemetry.summary import Metric


@dataclass(frozen=True)
class Result:
    """Result of one run."""

    config: CaseConfig
    metrics: tuple[Metric, ...]
    failure: str | None = None
    """why it stopped early; None if it ran to its end"""
    warnings: tuple[str, ...] = ()
    log: Path | None = None
    figures: tuple[Path, ...] = field(default=())
