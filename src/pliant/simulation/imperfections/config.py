"""Imperfections of a robot: the configuration of the whole chain, with the values of the papers."""

from __future__ import annotations

from pliant.configuration import Config
from pliant.quantity import quantity
from pliant.simulation.imperfections.actuation import ActuationConfig
from pliant.simulation.imperfections.ripple import RippleConfig
from pliant.simulation.imperfections.sensing import SensingConfig
from pliant.simulation.imperfections.torque_loop import TorqueLoopConfig


class Imperfections(Config):
    """Everything between a controller and the rigid-body physics. The defaults are a perfect robot."""

    computation_delay: float = quantity(
        0.0, "s", "δ_o: from a measurement to the effect of its command", ge=0.0, le=2.0
    )
    joint_damping: float = quantity(
        0.0, "N·m s/rad", "in the joints' mechanics, integrated by the plant inside", ge=0.0, le=1e3
    )
    torque_loop: TorqueLoopConfig = TorqueLoopConfig()
    actuation: ActuationConfig = ActuationConfig()
    ripple: RippleConfig = RippleConfig()
    sensing: SensingConfig = SensingConfig()

    @classmethod
    def perfect(cls) -> Imperfections:
        """A robot without imperfections: the plant inside, unchanged."""
        return cls()

    @classmethod
    def p3(cls, *, pid: bool = True, computation_delay: float = 5e-3) -> Imperfections:
        """The imperfect seven-joint arm of [FFMPC] sec. VI-B, its last joint locked; for a robot of any other number
        of joints the same values, from the base outwards: joints beyond the sixth have the noise of the sixth.

        Eq. 31 counts the torque sensor's delay of one cycle from the motor torque: what acted in the cycle that ends
        now, a reading without a delay here. The torque noise is the six values of the published code. That code also
        leaves out the sensing delay, drops the computation delay and fixes the bias at +2 N·m; here the paper's text
        stands.

        Args:
            pid: with the drives' torque loop, or with feed-forward alone.
            computation_delay: δ_o, s.
        """
        gains = TorqueLoopConfig(gain_p=0.7, gain_i=10.0, gain_d=1e-5)
        return cls(
            computation_delay=computation_delay,
            torque_loop=gains if pid else TorqueLoopConfig(),
            actuation=ActuationConfig(
                gain=(0.8, 1.2), bias=(-2.0, 2.0), dry_friction=1.0, friction_velocity=0.1, viscous_friction=0.5
            ),
            sensing=SensingConfig(
                delay=1e-3,
                delay_torque=0.0,
                noise_q=1e-3,
                noise_v=1e-3,
                noise_torque=(0.03, 0.03, 0.02, 0.02, 0.01, 0.01),
                noise_force=0.01,
                fit_joints=True,
            ),
        )

    @classmethod
    def p0_experiment4(cls) -> Imperfections:
        """The leg of [HapFIC] sec. III, experiment 4: slow and weak actuators, damped joints."""
        return cls(joint_damping=11.46, actuation=ActuationConfig(bandwidth=20.0, peak_torque=40.0))
