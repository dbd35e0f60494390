"""The predictive controllers by name."""

from __future__ import annotations

from collections.abc import Mapping

from pliant.mpc.config import ClassicalMpc, ForceFeedbackMpc, MpcConfig, TorqueFeedbackMpc

MPC_CONTROLLERS: Mapping[str, type[MpcConfig]] = {
    "force-feedback-mpc": ForceFeedbackMpc,
    "torque-feedback-mpc": TorqueFeedbackMpc,
    "classical-mpc": ClassicalMpc,
}
"""name → configuration with its defaults; `MpcController(robot, configuration)` runs it"""
