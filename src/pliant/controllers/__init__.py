"""Controllers that answer within one tick: fractal impedances, their stack, and baselines to compare with."""

from pliant.controllers.attractor import Law
from pliant.controllers.fractal_impedance import FractalImpedance
from pliant.controllers.phase_settings import PhaseSettings
from pliant.controllers.profiles import ForceProfile, Shape
from pliant.controllers.stack import Stack, StackState
from pliant.controllers.task import FrameTask
from pliant.lazy import make_callable

__all__ = ["ForceProfile", "FractalImpedance", "FrameTask", "Law", "PhaseSettings", "Shape", "Stack", "StackState"]

make_callable(__name__, "pliant.wiring.registry", "controllers")
