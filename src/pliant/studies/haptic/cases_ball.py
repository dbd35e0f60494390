"""Soft balls: [HapFIC] sec. III, experiments 3 and 4."""

from __future__ import annotations

from pliant.studies.haptic.config import BallConfig, Check, Environment, HapticConfig, Step

_X = 0.12  # m, of the ball
_Z = 0.21  # m: 10 mm below the foot's height when it touches the top
_BALL = BallConfig(position=(_X, 0.0, 0.1), mass=0.0)
_ABOVE = (0.0, 0.75, -1.9)  # rad, foot beside and above the ball
_FIXED = Environment(floor=None, ball=_BALL)

BALL_FIXED = HapticConfig(
    case="ball",
    duration=5.0,
    environment=_FIXED,
    start=_ABOVE,
    steps=(
        Step(time=0.0, name="reach", target=(_X, 0.0, _Z)),
        Step(time=2.0, name="15 N", force=(0.0, 0.0, 15.0)),
        Step(time=3.0, name="25 N", force=(0.0, 0.0, 25.0)),
        Step(time=4.0, name="8 N", force=(0.0, 0.0, 8.0)),
    ),
    checks=(
        Check(kind="settle", name="settle at 15 N", begin=2.0, end=3.0, wanted=15.0, target=0.15),
        Check(kind="settle", name="settle at 25 N", begin=3.0, end=4.0, wanted=25.0, before=15.0, target=0.15),
        Check(kind="settle", name="settle at 8 N", begin=4.0, wanted=8.0, before=25.0, target=0.3),
        Check(kind="max", name="error at 15 N", begin=2.8, end=3.0, wanted=15.0, target=0.02),
        Check(kind="max", name="error at 25 N", begin=3.8, end=4.0, wanted=25.0, target=0.02),
        Check(kind="max", name="error at 8 N", begin=4.8, wanted=8.0, target=0.02),
        Check(kind="breaks", name="contact breaks", begin=1.9, wanted=8.0, target=0.0),
    ),
    snapshots=(0.0, 1.9, 3.9, 4.9),
)

BALL_UNREACHABLE = HapticConfig(
    case="ball-unreachable",
    duration=4.0,
    environment=_FIXED,
    start=_ABOVE,
    steps=(
        Step(time=0.0, name="reach", target=(_X, 0.0, _Z), force=(0.0, 0.0, 8.0)),
        Step(time=2.0, name="60 N", force=(0.0, 0.0, 60.0)),
        Step(time=3.0, name="8 N", force=(0.0, 0.0, 8.0)),
    ),
    checks=(
        Check(kind="unreachable", name="said to be unreachable, share of time", begin=2.5, end=3.0, target=1.0),
        Check(kind="off-bound", name="Δx off its bound", begin=2.5, end=3.0, target=0.0),
        Check(kind="settle", name="settle back at 8 N", begin=3.0, wanted=8.0, target=0.3),
        Check(kind="max", name="error at 8 N", begin=3.8, wanted=8.0, target=0.02),
    ),
    snapshots=(1.9, 2.9, 3.9),
)

BALL_CASES = (BALL_FIXED, BALL_UNREACHABLE)
