"""What tests of the recorder share: whose run it is, and how ticks are recorded."""

from __future__ import annotations

import dataclasses
import io
from pathlib import Path

from pliant.signals import Tick
from pliant.telemetry import Recorder, RunInfo
from tests.telemetry.ticks import JOINTS

INFO = RunInfo(
    study="stack",
    case="figure8",
    controller="capped",
    robot="lwr4",
    seed=7,
    joints=JOINTS,
    torque_limits=(176.0,) * 7,
    config={"a": {"b": 1.5}},
)


def record(ticks: list[Tick], target: Path | io.BytesIO, **options: object) -> None:
    with Recorder(target, INFO, **options) as recorder:  # type: ignore[arg-type]
        for tick in ticks:
            recorder(tick)


def with_diagnostics(tick: Tick, **more: object) -> Tick:
    diagnostics = dict(tick.command.diagnostics) | more
    return dataclasses.replace(tick, command=dataclasses.replace(tick.command, diagnostics=diagnostics))
