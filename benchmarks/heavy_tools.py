"""What a force sensor makes of the tool that it carries: known, swung in free air, and unknown.

    python benchmarks/heavy_tools.py

Three lines: the true contact force while 20 N are asked for through a known tool of 2 kg (an iiwa 14 with a wrist
sensor, force-feedback control, second half of 3 s); what is left of the force of 0.8 kg that swings by 0.3 rad at 1 Hz
in all joints, and how many ticks believe in a contact; an unknown 0.5 kg without and with a tare, and the hint.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))

from pliant.estimation import CarriedMass, Tare, WrenchEstimator, start_hints
from pliant.robot import Robot
from pliant.simulation import ForceSensor, MujocoPlant
from tests.estimation.test_carried_mass import CENTER, INERTIA, MASS, rms_force, swung
from tests.mpc.test_heavy_tool import FORCE, LENGTH, pressed


def main() -> None:
    for told, carried in (("known", CarriedMass(2.0, (0.0, 0.0, LENGTH / 2))), ("not named", CarriedMass())):
        forces = pressed(2.0, carried)
        print(
            f"tool of 2 kg, {told}: {FORCE:g} N asked, mean {forces.mean():.2f} N, between {forces.min():.2f} and"
            f" {forces.max():.2f} N",
            flush=True,
        )
    robot = Robot.load("iiwa14")
    for told, load in (
        ("mass, centre and inertia known", CarriedMass(MASS, CENTER, inertia=INERTIA)),
        ("mass and centre known", CarriedMass(MASS, CENTER)),
        ("not named", CarriedMass()),
    ):
        seen = swung(robot, WrenchEstimator(robot, {"flange": load}))
        believed = sum(estimate.contacts["flange"] for estimate in seen)
        print(f"0.8 kg swung, {told}: {rms_force(seen):.3f} N rms, contact believed {believed} of {len(seen)} ticks")
    plant = MujocoPlant(robot, sensors=[ForceSensor("flange", 0.5)])
    for told, estimator in (
        ("without a tare", WrenchEstimator(robot)),
        ("with a tare", WrenchEstimator(robot, tare=Tare())),
    ):
        measurement, _ = plant.init()
        estimate, _ = estimator.step(measurement, estimator.init(measurement))
        left = np.linalg.norm(estimate.wrenches["flange"][:3])
        hint = start_hints(estimate)
        print(f"0.5 kg that nobody named, {told}: {left:.2f} N at t = 0, hint: {hint[0] if hint else 'none'}")


if __name__ == "__main__":
    main()
