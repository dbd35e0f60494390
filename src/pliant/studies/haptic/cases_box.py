"""A rigid box with friction: pressed from above, tipped over, met by the shank. [HapFIC] sec. III, experiment 2."""

from __future__ import annotations

from pliant.studies.haptic.config import Check
from pliant.studies.haptic.from_task import from_task
from pliant.studies.haptic.rows import plain

BOX_TOP = from_task(
    "box-top",
    checks=(
        Check(kind="rms", name="hold, rms", begin=1.2, end=2.0, wanted=40.0, target=0.05),
        Check(kind="rms", name="slide, rms", begin=2.0, wanted=40.0, target=0.4),
        Check(kind="max", name="slide, largest error", begin=2.0, wanted=40.0),
        Check(kind="breaks", name="contact breaks", begin=1.0, wanted=40.0, target=0.0),
    ),
    snapshots=(0.0, 1.5, 2.8, 4.8),
)

BOX_TIP = from_task(
    "box-tip",
    checks=(
        Check(kind="rms", name="side force before the tip, rms", begin=2.0, end=3.0, axis=0, wanted=-5.0, target=0.1),
        Check(kind="breaks", name="contact breaks before the tip", begin=1.5, end=3.0, axis=0, wanted=-5.0, target=0.0),
        Check(kind="tilt", name="box off a quarter turn", target=2.0),
        Check(kind="return", name="position error at the end", begin=7.0, target=0.1),
        Check(kind="speed", name="foot speed at the end", begin=7.0, target=0.01),
        Check(kind="peak", name="peak force"),
    ),
    snapshots=(0.0, 2.8, 3.7, 4.2, 7.1),
)

BOX_SHANK = from_task(
    "box-top",
    "box-shank",
    checks=(
        Check(kind="offset", name="largest Δx", target=0.0),
        Check(kind="return", name="position error with the shank on the box", begin=2.5, end=3.0),
        Check(kind="link", name="peak force on the shank"),
        Check(kind="return", name="position error after the return", begin=5.6, target=0.1),
    ),
    snapshots=(0.0, 0.9, 1.8, 2.8, 5.8),
)

BOX_CASES = tuple(plain(config) for config in (BOX_TOP, BOX_TIP, BOX_SHANK))
