"""Parameters that are known to work, and those the papers print."""

from __future__ import annotations

from pliant.controllers.config import FrameTaskConfig, RotationConfig, StackConfig, TranslationConfig


def _stack(end_effector: TranslationConfig, rotation: RotationConfig, elbow: TranslationConfig) -> StackConfig:
    ee = FrameTaskConfig(frame="flange", translation=end_effector, rotation=rotation)
    return StackConfig(tasks={"ee": ee, "elbow": FrameTaskConfig(frame="elbow", translation=elbow)})


STIFF_STACK = _stack(
    TranslationConfig(stiffness=20000.0, linear_range=0.006, range=0.02, force_max=150.0),
    RotationConfig(stiffness=300.0, linear_range=0.25, range=0.63, force_max=100.0),
    TranslationConfig(stiffness=5000.0, linear_range=0.01, range=0.02, force_max=50.0),
)
"""for 1 kHz: holds an arm against its own weight within millimetres, without a dynamic model"""

SOFT_STACK = _stack(
    TranslationConfig(stiffness=2500.0, linear_range=0.03, range=0.06, force_max=100.0),
    RotationConfig(stiffness=60.0, linear_range=0.15, range=0.30, force_max=12.0),
    TranslationConfig(stiffness=630.0, linear_range=0.01, range=0.02, force_max=10.0),
)
"""for about 333 Hz, and robots that compensate gravity themselves"""

TABLE_I_SIMULATION = _stack(
    TranslationConfig(stiffness=5000.0, linear_range=0.005, range=0.006, force_max=150.0),
    RotationConfig(stiffness=100.0, linear_range=0.057, range=0.63, force_max=100.0),
    TranslationConfig(stiffness=5000.0, linear_range=0.01, range=0.011, force_max=50.0),
)
"""[Stack] Tiseo et al. 2020, Table I, "Simulations" """

TABLE_I_ROBOT = _stack(
    TranslationConfig(stiffness=800.0, linear_range=0.06, range=0.08, force_max=100.0),
    RotationConfig(stiffness=60.0, linear_range=0.01, range=0.019, force_max=2.0),
    TranslationConfig(stiffness=630.0, linear_range=0.01, range=0.011, force_max=10.0),
)
"""[Stack] Tiseo et al. 2020, Table I, "Robot"; there the rotational F_max is printed as 0, here it is 2 N·m"""
