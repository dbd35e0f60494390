"""What a user may do to the leg while it works, and what may come between: changes, targets, delays, unknown scenes."""

from __future__ import annotations

from pliant.experiments.case import Case, Row
from pliant.references.exploration.config import ExplorationConfig
from pliant.studies.haptic.config import Check, HapticCaseConfig
from pliant.studies.haptic.delays import delay_figure, delay_rows
from pliant.studies.haptic.parameters import parameter_figure, parameter_rows
from pliant.studies.haptic.rows import PRINTED, drawn
from pliant.studies.haptic.scene_config import Floor, HapticScene, Material
from pliant.studies.haptic.steps_config import FootImpedance, HapticPlannerConfig, OnlineChanges, Step

_ROUGH = HapticScene(floor=Floor(material=Material()))

ONLINE = HapticCaseConfig(
    case="online",
    duration=15.0,
    environment=_ROUGH,
    steps=(Step(time=0.0, name="reach", target=(0.10, 0.0, 0.017), force=(0.0, 0.0, 20.0)),),
    online=OnlineChanges(),
    checks=(
        Check(kind="share", name="|W| over F_max", target=1.0),
        Check(kind="beyond-bound", name="Δx beyond x_b", target=0.0),
        Check(kind="speed", name="speed after settling", begin=14.8, target=0.1),
        Check(kind="speed", name="largest speed"),
        Check(kind="peak", name="peak force"),
    ),
)

_TARGETS: tuple[tuple[float, float, float], ...] = (
    (0.10, 0.00, 0.017),
    (0.10, 0.00, 0.060),
    (0.16, 0.05, 0.017),
    (0.18, -0.05, 0.017),
    (0.05, -0.08, 0.050),
    (0.02, 0.00, 0.017),
    (0.10, 0.08, 0.017),
    (0.12, 0.00, 0.080),
)
"""m; the foot touches at z = 0.02"""

TARGET_SEQUENCE = HapticCaseConfig(
    case="target-sequence",
    planner=HapticPlannerConfig(speed=0.1),
    exploration=ExplorationConfig(gain=90.0),  # 1/s: the motion presses on at up to 0.1 m/s where it finds the floor
    duration=9.6,
    environment=_ROUGH,
    steps=tuple(
        Step(time=1.2 * i, target=target, force=(0.0, 0.0, 30.0) if i == 0 else None)
        for i, target in enumerate(_TARGETS)
    ),
    checks=(
        Check(kind="over", name="largest force over F_d", target=10.0),
        Check(kind="share", name="|W| over F_max", target=1.0),
        Check(kind="rms", name="force at the end of the fourth target, rms", begin=4.6, end=4.8, wanted=30.0),
        Check(kind="rms", name="force at the end of the seventh target, rms", begin=8.2, end=8.4, wanted=30.0),
    ),
    snapshots=(1.1, 2.3, 4.7, 6.9, 9.5),
)


def _planned(kind: str) -> Row:
    """The same targets by another planner."""
    return Row(f"planner {kind}", changes={"planner": {"kind": kind}})


DELAY = HapticCaseConfig(
    case="delay",
    duration=2.0,
    environment=_ROUGH,
    steps=(
        Step(time=0.0, name="reach", target=(0.10, 0.0, 0.017), force=(0.0, 0.0, 15.0)),
        Step(time=1.2, name="10 N", force=(0.0, 0.0, 10.0)),
    ),
    checks=(
        Check(kind="rms", name="force, rms", begin=1.6, wanted=10.0),
        Check(kind="speed", name="speed at the end", begin=1.6),
        Check(kind="breaks", name="contact breaks", begin=0.9, wanted=10.0),
        Check(kind="peak", name="peak force"),
        Check(kind="share", name="|W| over F_max", target=1.0),
    ),
)

RANDOM = HapticCaseConfig(
    case="random",
    duration=3.0,
    random=True,
    impedance=FootImpedance(),
    steps=(Step(time=0.0, name="press", target=(0.10, 0.0, 0.015), force=(0.0, 0.0, 20.0)),),
    checks=(
        Check(kind="rms", name="force at rest, rms over F_d", begin=2.6, target=0.02, relative=True),
        Check(kind="breaks", name="contact breaks", begin=1.5, wanted=1.0, target=0.0),
        Check(kind="share", name="|W| over F_max", target=1.0),
        Check(kind="beyond-bound", name="Δx beyond x_b", target=0.0),
        Check(kind="speed", name="speed at rest", begin=2.6, target=0.01),
        Check(kind="peak", name="peak force"),
    ),
)

PARAMETERS = HapticCaseConfig(
    case="parameters",
    duration=2.4,
    environment=_ROUGH,
    steps=(
        Step(time=0.0, name="reach", target=(0.06, 0.0, 0.018), force=(0.0, 0.0, 10.0)),
        Step(time=1.4, name="15 N", force=(0.0, 0.0, 15.0)),
        Step(time=1.9, name="10 N", force=(0.0, 0.0, 10.0)),
    ),
    checks=(
        Check(kind="settle", name="up", begin=1.4, end=1.9, wanted=15.0, before=10.0),
        Check(kind="settle", name="down", begin=1.9, wanted=10.0, before=15.0),
        Check(kind="peak", name="peak force", end=1.4),
        Check(kind="share", name="|W| over F_max", target=1.0),
    ),
)

ONLINE_CASES = (
    drawn(ONLINE, seeds=3),
    Case(DELAY, (Row(), *delay_rows()), figures=[delay_figure]),
    Case(TARGET_SEQUENCE, (Row(), PRINTED, *(_planned(kind) for kind in ("attractor", "printed")))),
    drawn(RANDOM, seeds=20),
    Case(PARAMETERS, (Row(), *parameter_rows()), figures=[parameter_figure]),
)
