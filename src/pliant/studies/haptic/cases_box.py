"""A rigid box with friction: pressed from above, tipped over, met by the shank. [HapFIC] sec. III, experiment 2."""

from __future__ import annotations

from pliant.studies.haptic.config import Check, HapticCaseConfig
from pliant.studies.haptic.rows import plain
from pliant.studies.haptic.scene_config import BoxConfig, Floor, HapticScene, Material
from pliant.studies.haptic.steps_config import Step

_ROUGH = Floor(material=Material())


def _beside(x: float) -> HapticScene:
    """A box of 0.12 m width, 0.2 m high, centred at x, on a floor with friction; the shank touches, too."""
    return HapticScene(floor=_ROUGH, box=BoxConfig(position=(x, 0.0, 0.1)), shank=True)


BOX_TOP = HapticCaseConfig(
    case="box-top",
    duration=6.0,
    environment=_beside(0.16),
    start=(0.0, 0.5815, -2.1912),  # foot at x = 0.16 m, z = 0.26 m
    steps=(
        Step(time=0.0, name="press", target=(0.16, 0.0, 0.217), force=(0.0, 0.0, 40.0)),
        Step(time=2.0, name="slide", target=(0.16, 0.06, 0.217)),
        Step(time=3.5, name="back", target=(0.16, -0.06, 0.217)),
        Step(time=5.0, name="centre", target=(0.16, 0.0, 0.217)),
    ),
    checks=(
        Check(kind="rms", name="hold, rms", begin=1.2, end=2.0, wanted=40.0, target=0.05),
        Check(kind="rms", name="slide, rms", begin=2.0, wanted=40.0, target=0.4),
        Check(kind="max", name="slide, largest error", begin=2.0, wanted=40.0),
        Check(kind="breaks", name="contact breaks", begin=1.0, wanted=40.0, target=0.0),
    ),
    snapshots=(0.0, 1.5, 2.8, 4.8),
)

BOX_TIP = HapticCaseConfig(
    case="box-tip",
    duration=7.2,
    environment=_beside(0.24),
    start=(0.0, 0.74, -2.1705),  # foot at x = 0.12 m, z = 0.24 m
    steps=(
        Step(time=0.0, name="reach", target=(0.12, 0.0, 0.17)),
        Step(time=0.8, name="push", target=(0.163, 0.0, 0.17), force=(-5.0, 0.0, 0.0)),
        Step(time=3.0, name="tip", target=(0.31, 0.0, 0.19), force=(-8.0, 0.0, 0.0)),
        Step(time=4.8, name="leave", target=(0.12, 0.0, 0.25), force=(0.0, 0.0, 0.0)),
    ),
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

BOX_SHANK = HapticCaseConfig(
    case="box-shank",
    duration=6.0,
    environment=_beside(0.16),
    start=(0.0, 0.5815, -2.1912),
    steps=(
        Step(time=0.0, name="lift", target=(0.20, 0.0, 0.28), force=(0.0, 0.0, 20.0)),
        Step(time=1.0, name="over the box", target=(0.33, 0.0, 0.17)),
        Step(time=3.0, name="return", target=(0.20, 0.0, 0.30)),
    ),
    checks=(
        Check(kind="offset", name="largest Δx", target=0.0),
        Check(kind="return", name="position error with the shank on the box", begin=2.5, end=3.0),
        Check(kind="link", name="peak force on the shank"),
        Check(kind="return", name="position error after the return", begin=5.6, target=0.1),
    ),
    snapshots=(0.0, 0.9, 1.8, 2.8, 5.8),
)

BOX_CASES = tuple(plain(config) for config in (BOX_TOP, BOX_TIP, BOX_SHANK))
