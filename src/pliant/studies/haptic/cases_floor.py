"""Holding and sliding on a rigid floor without friction: [HapFIC] sec. III, experiment 1."""

from __future__ import annotations

from pliant.studies.haptic.config import Check, HapticCaseConfig
from pliant.studies.haptic.rows import plain
from pliant.studies.haptic.scene_config import Hardware
from pliant.studies.haptic.steps_config import Step

_Z = 0.017  # m: the target lies 3 mm below the surface
_STEPS = (
    Step(time=0.0, name="reach", target=(0.10, 0.0, _Z), force=(0.0, 0.0, 40.0)),
    Step(time=2.0, name="slide forward", target=(0.20, 0.0, _Z)),
    Step(time=3.5, name="slide back", target=(0.0, 0.0, _Z)),
    Step(time=5.5, name="return", target=(0.10, 0.0, _Z)),
    Step(time=7.0, name="80 N", force=(0.0, 0.0, 80.0)),
    Step(time=7.6, name="20 N", force=(0.0, 0.0, 20.0)),
)

FLOOR = HapticCaseConfig(
    case="floor",
    duration=8.2,
    steps=_STEPS,
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

FLOOR_NOISE = HapticCaseConfig(
    case="floor-noise",
    duration=3.0,
    hardware=Hardware(force_noise=1.0),
    steps=_STEPS[:1],
    checks=(
        Check(kind="rms", name="hold, rms", begin=1.2, wanted=40.0, target=0.25),
        Check(kind="breaks", name="contact breaks", begin=1.0, wanted=40.0, target=0.0),
    ),
)

FLOOR_CASES = tuple(plain(config) for config in (FLOOR, FLOOR_NOISE))
