"""Experiment 4 of [HapFIC] sec. III in one scene, and targets that come as a slow and late stream (sec. V)."""

from __future__ import annotations

from pliant.experiments.case import Case, Changes, Row, once
from pliant.studies.haptic.config import Check
from pliant.studies.haptic.from_task import from_task
from pliant.studies.haptic.rows import PRINTED, plain

EXPERIMENT_4 = from_task(
    "experiment-4",
    checks=(
        Check(kind="max", name="error at 15 N on the ball", begin=5.1, end=5.5, wanted=15.0, target=0.1),
        Check(kind="rms", name="hold at 40 N on the floor, rms", begin=15.4, wanted=40.0, target=0.3),
        Check(kind="peak", name="peak force"),
        Check(kind="share", name="|W| over F_max", target=1.0),
        Check(kind="speed", name="foot speed at the end", begin=15.8, target=0.1),
    ),
    snapshots=(2.9, 5.4, 13.1, 15.9),
)

TARGET_STREAM = from_task(
    "target-stream",
    checks=(
        Check(kind="rms", name="force while the stream moves, rms", begin=3.0, wanted=20.0),
        Check(kind="max", name="largest force error", begin=3.0, wanted=20.0),
        Check(kind="breaks", name="contact breaks", begin=1.5, wanted=20.0, target=0.0),
        Check(kind="share", name="|W| over F_max", target=1.0),
    ),
)


def _late(seconds: float) -> Row:
    """The same stream that comes later: what an operator's hand does, ten times a second."""
    first, *stream = TARGET_STREAM.steps
    moved = [step.model_copy(update={"time": step.time + seconds}) for step in stream]
    in_time = [step for step in moved if step.time < TARGET_STREAM.duration - 1e-9]
    changes: Changes = {"steps": [step.model_dump() for step in (first, *in_time)]}
    return Row(f"{seconds:g} s late", changes=changes)


STREAM_CASES = (
    plain(EXPERIMENT_4),
    Case(TARGET_STREAM, (Row(), PRINTED, *(_late(seconds) for seconds in (0.1, 0.5, 1.0))), once),
)
