"""What a user may do to the leg while it works, and what may come between: changes, targets, delays, unknown scenes."""

from __future__ import annotations

from pliant.experiments.case import Case, Row
from pliant.studies.haptic.config import Check
from pliant.studies.haptic.delays import delay_figure, delay_rows
from pliant.studies.haptic.from_task import from_task
from pliant.studies.haptic.parameters import parameter_figure, parameter_rows
from pliant.studies.haptic.rows import PRINTED, drawn
from pliant.studies.haptic.steps_config import OnlineChanges

ONLINE = from_task(
    "online",
    checks=(
        Check(kind="share", name="|W| over F_max", target=1.0),
        Check(kind="beyond-bound", name="Δx beyond x_b", target=0.0),
        Check(kind="speed", name="speed after settling", begin=14.8, target=0.1),
        Check(kind="speed", name="largest speed"),
        Check(kind="peak", name="peak force"),
    ),
    online=OnlineChanges(),
)

TARGET_SEQUENCE = from_task(
    "target-sequence",
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


DELAY = from_task(
    "delay",
    checks=(
        Check(kind="rms", name="force, rms", begin=1.6, wanted=10.0),
        Check(kind="speed", name="speed at the end", begin=1.6),
        Check(kind="breaks", name="contact breaks", begin=0.9, wanted=10.0),
        Check(kind="peak", name="peak force"),
        Check(kind="share", name="|W| over F_max", target=1.0),
    ),
)

RANDOM = from_task(
    "random",
    checks=(
        Check(kind="rms", name="force at rest, rms over F_d", begin=2.6, target=0.02, relative=True),
        Check(kind="breaks", name="contact breaks", begin=1.5, wanted=1.0, target=0.0),
        Check(kind="share", name="|W| over F_max", target=1.0),
        Check(kind="beyond-bound", name="Δx beyond x_b", target=0.0),
        Check(kind="speed", name="speed at rest", begin=2.6, target=0.01),
        Check(kind="peak", name="peak force"),
    ),
    random=True,
)

PARAMETERS = from_task(
    "parameters",
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
