"""Soft balls: [HapFIC] sec. III, experiments 3 and 4."""

from __future__ import annotations

from pliant.studies.haptic.config import Check
from pliant.studies.haptic.from_task import from_task
from pliant.studies.haptic.rows import plain


def _checks(forces: tuple[float, float, float], settle: tuple[float, float, float]) -> tuple[Check, ...]:
    """Settling within 5 % of each step, and what is left of the error at its end."""
    checks: list[Check] = []
    for i, (force, bound) in enumerate(zip(forces, settle, strict=True)):
        begin, before = 2.0 + i, forces[i - 1] if i else None
        checks += [
            Check(
                kind="settle",
                name=f"settle at {force:g} N",
                begin=begin,
                end=begin + 1.0,
                wanted=force,
                before=before,
                target=bound,
            ),
            Check(
                kind="max", name=f"error at {force:g} N", begin=begin + 0.8, end=begin + 1.0, wanted=force, target=0.02
            ),
        ]
    return (*checks, Check(kind="breaks", name="contact breaks", begin=1.9, end=5.0, wanted=1.0, target=0.0))


_FORCES = (15.0, 25.0, 8.0)  # N

BALL = from_task(
    "ball",
    checks=_checks(_FORCES, (0.15, 0.15, 0.3)),
    snapshots=(0.0, 1.9, 3.9, 4.9),
)

_LIGHT = (8.0, 12.0, 5.0)  # N, on a ball that gives way above and below

BALL_FREE = from_task(
    "ball-free",
    checks=(
        *_checks(_LIGHT, (0.15, 0.15, 0.3)),
        Check(kind="link", name="peak force on the shank"),
        Check(kind="knee", name="knee off straight, least", begin=8.9, target=5.0),
        Check(kind="speed", name="foot speed at the end", begin=13.6, target=0.1),
        Check(kind="return", name="position error at the end", begin=13.6, target=1.0),
        Check(kind="share", name="|W| over F_max", target=1.0),
    ),
    snapshots=(0.0, 3.9, 7.2, 8.3, 10.3, 13.7),
)

_REACHABLE = 32.3  # N: (x_b + p) K_e K_0/(K_e + K_0) with p = 10 mm, K_e = 1e3 N/m, K_0 = 12e3 N/m

BALL_UNREACHABLE = from_task(
    "ball",
    "ball-unreachable",
    checks=(
        Check(kind="unreachable", name="said to be unreachable, share of time", begin=2.5, end=3.0, target=1.0),
        Check(
            kind="reachable",
            name="error of the reachable force that it names",
            begin=2.5,
            end=3.0,
            wanted=_REACHABLE,
            target=0.1,
        ),
        Check(kind="off-bound", name="Δx off its bound", begin=2.5, end=3.0, target=0.0),
        Check(kind="settle", name="settle back at 8 N", begin=3.0, wanted=8.0, target=0.3),
        Check(kind="max", name="error at 8 N", begin=3.8, wanted=8.0, target=0.02),
    ),
    snapshots=(1.9, 2.9, 3.9),
)

# [HapFIC] sec. III, experiment 4
BALL_ACTUATOR = from_task("ball", "ball-actuator", checks=_checks(_FORCES, (0.25, 0.2, 0.4)), snapshots=BALL.snapshots)

FLOOR_ACTUATOR = from_task(
    "floor",
    "floor-actuator",
    checks=(
        Check(kind="rms", name="hold, rms", begin=1.5, end=2.5, wanted=40.0, target=0.05),
        Check(kind="rms", name="slide, rms", begin=2.5, wanted=40.0, target=0.3),
        Check(kind="max", name="slide, largest error", begin=2.5, wanted=40.0),
        Check(kind="breaks", name="contact breaks", begin=1.5, wanted=40.0, target=0.0),
    ),
)

BALL_CASES = tuple(plain(config) for config in (BALL, BALL_FREE, BALL_UNREACHABLE, BALL_ACTUATOR, FLOOR_ACTUATOR))
