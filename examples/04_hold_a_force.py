"""Hold a force: a leg lowers its foot until it touches the floor, presses with 40 N, then with 80 N, then with 20 N.

Nobody tells the leg where the floor is or how stiff it is. A planner moves the target 3 mm below where the floor
happens to be; the fractal impedance limits the force; the haptic exploration shifts the target by Δx, at most x_b,
until the force sensor reads what is desired.

Run it:  python examples/04_hold_a_force.py

It prints desired and true force, the offset Δx, and what the exploration does (0 off, 1 free, 2 contact, 3 lost).
"""

from __future__ import annotations

import numpy as np

from pliant import loop
from pliant.controllers.fractal_impedance import FractalImpedance
from pliant.controllers.profiles import Shape
from pliant.controllers.task import FrameTask
from pliant.estimation import WrenchEstimator
from pliant.references.exploration.config import ExplorationConfig
from pliant.references.exploration.haptic_exploration import HapticExploration
from pliant.references.planners.harmonic_planner import HarmonicPlanner
from pliant.references.schedule import Schedule
from pliant.robot import Robot
from pliant.signals import ImpedanceTuning, Reference, TaskReference, Tick
from pliant.simulation import ForceSensor, JointEffects, MujocoPlant, Scene, Surface, floor

PERIOD = 1e-3  # s
RIGID = Surface(stiffness=1e6, damping=1e4, friction=0.0)  # N/m, N s/m, frictionless

tuning = ImpedanceTuning(
    stiffness=np.array([6000.0, 6000.0, 12000.0]),  # K_0, N/m: force per error near the target
    force_max=np.array([150.0, 150.0, 300.0]),  # F_max, N: the force never exceeds it
    range=np.array([0.025, 0.025, 0.025]),  # x_b, m: how far the exploration may shift the target
)


def wish(force_z: float) -> Reference:
    """Foot 3 mm below the floor's surface (its radius is 20 mm), pressed by `force_z` N."""
    target = np.array([0.10, 0.0, 0.017])  # m
    wrench = np.array([0.0, 0.0, force_z, 0.0, 0.0, 0.0])  # N and N·m: the floor's reaction on the foot
    return Reference(0.0, (TaskReference("foot", target, wrench=wrench, tuning=tuning),))


def show(tick: Tick) -> None:
    """Prints ten lines a second."""
    if round(tick.measurement.time / PERIOD) % 100 or tick.truth is None:
        return
    diagnostics = tick.reference.diagnostics
    offset = 1e3 * np.asarray(diagnostics.get("exploration/foot/offset", np.zeros(3)))[2]
    phase = np.asarray(diagnostics.get("exploration/foot/phase", np.zeros(3)))[2]
    desired, true = tick.reference.tasks[0].wrench[2], tick.truth.wrenches["foot"][2]
    print(f"{tick.measurement.time:5.1f} {desired:10.1f} {true:10.3f} {offset:10.3f} {phase:7.0f}")


def main() -> None:
    robot = Robot.load("leg3")
    plant = MujocoPlant(
        robot,
        Scene((floor(0.0, RIGID),), contact="explicit"),
        period=PERIOD,
        joints=JointEffects(compensation="gravity"),
        sensors=[ForceSensor("foot")],
    )
    targets = Schedule([(0.0, wish(40.0)), (1.2, wish(80.0)), (1.8, wish(20.0))])
    source = HapticExploration(HarmonicPlanner(targets, robot.placement), ExplorationConfig(gain=45.0))  # 1/s
    controller = FractalImpedance(robot, FrameTask("foot", tuning, "foot", Shape.TANH), PERIOD)
    print(f"{'s':>5} {'desired N':>10} {'true N':>10} {'Δx mm':>10} {'phase':>7}")
    outcome = loop.run(plant, WrenchEstimator(robot), source, controller, range(2400), [show])
    if outcome.failure is not None:
        raise SystemExit(outcome.failure)


if __name__ == "__main__":
    main()
