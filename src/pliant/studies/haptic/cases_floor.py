"""Holding and sliding on a rigid floor without friction: [HapFIC] sec. III, experiment 1."""

from __future__ import annotations

from pliant.experiments.case import Case, Row, once
from pliant.studies.haptic.config import Check
from pliant.studies.haptic.from_task import from_task
from pliant.studies.haptic.rows import PRINTED, PROFILE_PRINTED, plain

FLOOR = from_task(
    "floor",
    checks=(
        Check(kind="rms", name="hold, rms", begin=1.2, end=2.0, wanted=40.0, target=0.05),
        Check(kind="rms", name="slide, rms", begin=2.0, end=7.0, wanted=40.0, target=0.2),
        Check(kind="max", name="slide, largest error", begin=2.0, end=7.0, wanted=40.0, target=1.5),
        Check(kind="settle", name="settle, 40 → 80 N", begin=7.0, end=7.6, wanted=80.0, before=40.0, target=0.10),
        Check(kind="settle", name="settle, 80 → 20 N", begin=7.6, wanted=20.0, before=80.0, target=0.10),
        Check(kind="breaks", name="contact breaks", begin=1.0, wanted=40.0, target=0.0),
        Check(kind="lateral", name="lateral error", begin=1.2, target=0.3),
        Check(kind="peak", name="peak force of the run"),
    ),
    snapshots=(0.0, 0.75, 2.75, 4.5, 8.0),
)

FLOOR_NOISE = from_task(
    "floor",
    "floor-noise",
    checks=(
        Check(kind="rms", name="hold, rms", begin=1.2, wanted=40.0, target=0.25),
        Check(kind="breaks", name="contact breaks", begin=1.0, wanted=40.0, target=0.0),
    ),
)

FLOOR_CASES = (Case(FLOOR, (Row(), PRINTED, PROFILE_PRINTED), once), plain(FLOOR_NOISE))
