"""Soft balls: [HapFIC] sec. III, experiments 3 and 4."""

from __future__ import annotations

from pliant.references.exploration.config import ExplorationConfig
from pliant.studies.haptic.config import Check, HapticCaseConfig
from pliant.studies.haptic.rows import plain
from pliant.studies.haptic.scene_config import BallConfig, Floor, HapticScene, Hardware, Material
from pliant.studies.haptic.steps_config import FootImpedance, HapticPlannerConfig, Step

_X = 0.12  # m, of the ball
_Z = 0.21  # m: 10 mm below the foot's height when it touches the top
_ABOVE = (0.0, 0.7489, -2.2459)  # rad: foot at x = 0.12 m, z = 0.26 m
_FIXED = HapticScene(floor=None, ball=BallConfig(position=(_X, 0.0, 0.1), mass=0.0))
_FREE = HapticScene(floor=Floor(material=Material()), ball=BallConfig(position=(_X, 0.0, 0.1)), shank=True)


def _steps(forces: tuple[float, float, float]) -> tuple[Step, ...]:
    """Down to the ball, then three forces, a second each."""
    reach = Step(time=0.0, name="reach", target=(_X, 0.0, _Z))
    return reach, *(Step(time=2.0 + i, name=f"{f:g} N", force=(0.0, 0.0, f)) for i, f in enumerate(forces))


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

BALL = HapticCaseConfig(
    case="ball",
    duration=5.0,
    environment=_FIXED,
    start=_ABOVE,
    steps=_steps(_FORCES),
    checks=_checks(_FORCES, (0.15, 0.15, 0.3)),
    snapshots=(0.0, 1.9, 3.9, 4.9),
)

_BRISK = ExplorationConfig(gain=60.0)  # 1/s: the estimated stiffness slows the regulation down where it rings
_LIGHT = (8.0, 12.0, 5.0)  # N, on a ball that gives way above and below

BALL_FREE = HapticCaseConfig(
    case="ball-free",
    duration=13.8,
    environment=_FREE,
    exploration=_BRISK,
    start=_ABOVE,
    steps=(
        *_steps(_LIGHT),
        Step(time=5.0, name="lift", target=(_X, 0.0, 0.27), force=(0.0, 0.0, 0.0)),
        Step(time=5.8, name="over", target=(0.30, 0.0, 0.27)),
        Step(time=7.3, name="kick", target=(0.30, 0.0, 0.08)),  # the shank comes down on the ball
        Step(time=8.9, name="stretch", target=(0.44, 0.0, 0.06)),  # m, 13 mm beyond the straight leg
        Step(time=10.4, name="return", target=(0.10, 0.0, 0.15)),
    ),
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

BALL_UNREACHABLE = HapticCaseConfig(
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
_ACTUATOR = Hardware(joint_damping=11.46, bandwidth=20.0, peak_torque=40.0)
_SOFTER = FootImpedance(stiffness=(6000.0, 6000.0, 6000.0), force_max=(150.0, 150.0, 150.0))

BALL_ACTUATOR = BALL.model_copy(
    update={
        "case": "ball-actuator",
        "hardware": _ACTUATOR,
        "impedance": _SOFTER,
        "exploration": _BRISK,
        "checks": _checks(_FORCES, (0.25, 0.2, 0.4)),
    }
)

FLOOR_ACTUATOR = HapticCaseConfig(
    case="floor-actuator",
    duration=7.5,
    hardware=_ACTUATOR,
    impedance=_SOFTER,
    exploration=_BRISK,
    planner=HapticPlannerConfig(speed=0.05),  # m/s: the joints' damping lets the foot lag behind by 9 mm at 0.2 m/s
    start=(0.0, 0.5402, -1.2266),
    steps=(
        Step(time=0.0, name="reach", target=(0.08, 0.0, 0.017), force=(0.0, 0.0, 40.0)),
        Step(time=2.5, name="slide", target=(0.14, 0.0, 0.017)),
        Step(time=5.0, name="back", target=(0.08, 0.0, 0.017)),
    ),
    checks=(
        Check(kind="rms", name="hold, rms", begin=1.5, end=2.5, wanted=40.0, target=0.05),
        Check(kind="rms", name="slide, rms", begin=2.5, wanted=40.0, target=0.3),
        Check(kind="max", name="slide, largest error", begin=2.5, wanted=40.0),
        Check(kind="breaks", name="contact breaks", begin=1.5, wanted=40.0, target=0.0),
    ),
)

BALL_CASES = tuple(plain(config) for config in (BALL, BALL_FREE, BALL_UNREACHABLE, BALL_ACTUATOR, FLOOR_ACTUATOR))
