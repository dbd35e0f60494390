"""Estimators: filters, contact wrenches, disturbances, environments and surfaces."""

from pliant.estimation.carried_mass import CarriedMass
from pliant.estimation.complementary_force import ComplementaryForce
from pliant.estimation.direct import DirectEstimator
from pliant.estimation.environment import EnvironmentEstimator
from pliant.estimation.environment_fit import EnvironmentFit, FitConfig
from pliant.estimation.external_torque import ExternalTorqueEstimator
from pliant.estimation.filtered import FilteredEstimator
from pliant.estimation.filters import Butterworth, FirstOrder, LowPass
from pliant.estimation.identification_poses import identification_poses
from pliant.estimation.joint_acceleration import JointAcceleration
from pliant.estimation.joint_state import JointStateFilter
from pliant.estimation.modelled_torque import ModelledTorqueEstimator
from pliant.estimation.momentum_observer import MomentumObserver
from pliant.estimation.start_hints import start_hints
from pliant.estimation.surface_fit import SurfaceEstimator, SurfaceFitConfig
from pliant.estimation.tare import Tare
from pliant.estimation.tool_identification import ToolIdentification, excitation, identify_tool
from pliant.estimation.wrench import TouchThresholds, WrenchEstimator

__all__ = [
    "Butterworth",
    "CarriedMass",
    "ComplementaryForce",
    "DirectEstimator",
    "EnvironmentEstimator",
    "EnvironmentFit",
    "ExternalTorqueEstimator",
    "FilteredEstimator",
    "FirstOrder",
    "FitConfig",
    "JointAcceleration",
    "JointStateFilter",
    "LowPass",
    "ModelledTorqueEstimator",
    "MomentumObserver",
    "SurfaceEstimator",
    "SurfaceFitConfig",
    "Tare",
    "ToolIdentification",
    "TouchThresholds",
    "WrenchEstimator",
    "excitation",
    "identification_poses",
    "identify_tool",
    "start_hints",
]
