"""What the robot believes about itself and about its contacts."""

from pliant.estimation.direct import DirectEstimator
from pliant.estimation.wrench import CarriedMass, TouchThresholds, WrenchEstimator

__all__ = ["CarriedMass", "DirectEstimator", "TouchThresholds", "WrenchEstimator"]
