"""What the robot believes about itself and about its contacts."""

from pliant.estimation.direct import DirectEstimator

__all__ = ["DirectEstimator"]
