"""Experiment 4 of [HapFIC] sec. III in one scene, and targets that come as a slow and late stream (sec. V)."""

from __future__ import annotations

import math

from pliant.experiments.case import Case, Changes, Row, once
from pliant.references.exploration.config import ExplorationConfig
from pliant.studies.haptic.config import Check, HapticCaseConfig
from pliant.studies.haptic.rows import PRINTED, plain
from pliant.studies.haptic.scene_config import BallConfig, Floor, HapticScene, Hardware, Material
from pliant.studies.haptic.steps_config import FootImpedance, HapticPlannerConfig, Step

_BALL_X, _FLOOR_X = 0.20, -0.02  # m

EXPERIMENT_4 = HapticCaseConfig(
    case="experiment-4",
    duration=16.0,
    environment=HapticScene(floor=Floor(material=Material()), ball=BallConfig(position=(_BALL_X, 0.0, 0.1), mass=0.0)),
    hardware=Hardware(joint_damping=11.46, bandwidth=20.0, peak_torque=40.0),
    impedance=FootImpedance(stiffness=(6000.0, 6000.0, 6000.0), force_max=(150.0, 150.0, 150.0)),
    exploration=ExplorationConfig(gain=60.0),
    planner=HapticPlannerConfig(speed=0.08),
    steps=(
        Step(time=0.0, name="above the ball", target=(_BALL_X, 0.0, 0.27)),
        Step(time=3.0, name="15 N", target=(_BALL_X, 0.0, 0.21), force=(0.0, 0.0, 15.0)),
        Step(time=5.5, name="lift", target=(_BALL_X, 0.0, 0.28), force=(0.0, 0.0, 0.0)),
        Step(time=7.0, name="over the floor", target=(_FLOOR_X, 0.0, 0.08)),
        Step(time=13.2, name="40 N", target=(_FLOOR_X, 0.0, 0.017), force=(0.0, 0.0, 40.0)),
    ),
    checks=(
        Check(kind="max", name="error at 15 N on the ball", begin=5.1, end=5.5, wanted=15.0, target=0.1),
        Check(kind="rms", name="hold at 40 N on the floor, rms", begin=15.4, wanted=40.0, target=0.3),
        Check(kind="peak", name="peak force"),
        Check(kind="share", name="|W| over F_max", target=1.0),
        Check(kind="speed", name="foot speed at the end", begin=15.8, target=0.1),
    ),
    snapshots=(2.9, 5.4, 13.1, 15.9),
)

_RATE = 10.0  # Hz, of the stream
_LENGTH = 6.0  # s
_HEIGHT = 0.017  # m, 3 mm below where the foot touches


def _streamed(late: float) -> tuple[Step, ...]:
    """What an operator's hand does, ten times a second and late: ±50 mm along the floor in 3 s, pressed with 20 N."""
    first = Step(time=0.0, name="reach", target=(0.10, 0.0, _HEIGHT), force=(0.0, 0.0, 20.0))
    moved: list[Step] = []
    for k in range(round((_LENGTH - 1.5 - late) * _RATE)):
        x = 0.10 + 0.05 * math.sin(2.0 * math.pi * k / _RATE / 3.0)
        moved.append(Step(time=1.5 + late + k / _RATE, name="stream" if k == 0 else "", target=(x, 0.0, _HEIGHT)))
    return first, *moved


def _late(seconds: float) -> Row:
    changes: Changes = {"steps": [step.model_dump() for step in _streamed(seconds)]}
    return Row(f"{seconds:g} s late", changes=changes)


TARGET_STREAM = HapticCaseConfig(
    case="target-stream",
    duration=_LENGTH,
    environment=HapticScene(floor=Floor(material=Material())),
    planner=HapticPlannerConfig(speed=0.3),
    steps=_streamed(0.0),
    checks=(
        Check(kind="rms", name="force while the stream moves, rms", begin=3.0, wanted=20.0),
        Check(kind="max", name="largest force error", begin=3.0, wanted=20.0),
        Check(kind="breaks", name="contact breaks", begin=1.5, wanted=20.0, target=0.0),
        Check(kind="share", name="|W| over F_max", target=1.0),
    ),
)

STREAM_CASES = (
    plain(EXPERIMENT_4),
    Case(TARGET_STREAM, (Row(), PRINTED, *(_late(seconds) for seconds in (0.1, 0.5, 1.0))), once),
)
