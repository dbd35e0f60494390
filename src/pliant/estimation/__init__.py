"""What the robot believes about itself and about its contacts."""

from pliant.estimation.direct import DirectEstimator
from pliant.estimation.filtered import FilteredEstimator
from pliant.estimation.filters import Butterworth, FirstOrder, LowPass
from pliant.estimation.momentum_observer import MomentumObserver
from pliant.estimation.wrench import CarriedMass, TouchThresholds, WrenchEstimator

__all__ = [
    "Butterworth",
    "CarriedMass",
    "DirectEstimator",
    "FilteredEstimator",
    "FirstOrder",
    "LowPass",
    "MomentumObserver",
    "TouchThresholds",
    "WrenchEstimator",
]
