"""What the seed decides: changes made online, and scenes nobody chose."""

from __future__ import annotations

from typing import Any

import numpy as np

from pliant.studies.haptic.config import HapticCaseConfig
from pliant.studies.haptic.safety import profile_along, reachable_force
from pliant.studies.haptic.scene import FOOT_RADIUS, touching_height
from pliant.studies.haptic.scene_config import Floor, HapticScene, Hardware, Material
from pliant.studies.haptic.steps_config import OnlineChanges, Step

_DEPTH = 0.003  # m of the target below where the foot touches


def drawn(config: HapticCaseConfig) -> HapticCaseConfig:
    """The configuration with every random choice made. The same seed gives the same one."""
    scene, changes = (np.random.default_rng(seed) for seed in np.random.SeedSequence(config.seed).spawn(2))
    update: dict[str, Any] = {}
    if config.random:
        update |= _scene(config, scene)
    if config.online is not None:
        update |= {"steps": (*config.steps, *_changes(config.online, changes)), "online": None}
    return config.model_copy(update=update) if update else config


def _scene(config: HapticCaseConfig, rng: np.random.Generator) -> dict[str, Any]:
    """Stiffness 3e2 to 1e6 N/m, friction 0 to 1, tilt to ±20°, masses ±50 %, and a force that such a surface bears."""
    stiffness = float(np.exp(rng.uniform(np.log(3e2), np.log(1e6))))
    friction = float(rng.uniform(0.0, 1.0))
    tilt = np.deg2rad(rng.uniform(-20.0, 20.0, 2))
    masses = tuple(rng.uniform(0.5, 1.5, 3).tolist())
    material = Material(
        stiffness=stiffness,
        damping=stiffness ** (2.0 / 3.0),  # between the rigid and the soft material of [HapFIC]
        friction=friction,
        friction_moving=0.6 * friction,
    )
    floor = Floor(tilt=(float(tilt[0]), float(tilt[1]), 0.0), material=material)
    profile = profile_along(2, config.impedance.tuning(), config)
    most = reachable_force(0.0, stiffness, profile, 0.8 * config.impedance.range[2])
    force = min(float(rng.uniform(10.0, 40.0)), most)
    x, y, _ = config.steps[0].target or (0.0, 0.0, 0.0)
    target = (x, y, touching_height(floor, x, y, FOOT_RADIUS) - _DEPTH)
    first = config.steps[0].model_copy(update={"target": target, "force": (0.0, 0.0, force)})
    steps = (first, *config.steps[1:])
    hardware: Hardware = config.hardware.model_copy(update={"mass_scale": masses})
    return {"environment": HapticScene(floor=floor), "hardware": hardware, "steps": steps, "random": False}


def _changes(online: OnlineChanges, rng: np.random.Generator) -> tuple[Step, ...]:
    """Any of six values changes at a time, whatever the others are."""
    steps: list[Step] = []
    for index in range(online.count):
        steps.append(_change(online.begin + index / online.rate, rng))
    last = steps[-1].time + 1.0 / online.rate
    quiet = Step(time=last, name="quiet", target=(0.10, 0.0, 0.06), force=(0.0, 0.0, 0.0))
    return (*steps, quiet)


def _change(time: float, rng: np.random.Generator) -> Step:
    kind = ("force", "stiffness", "force_max", "range", "reset", "target")[int(rng.integers(6))]
    values: dict[str, Any] = {
        "force": (*rng.uniform(-15.0, 15.0, 2), rng.uniform(-40.0, 120.0)),
        "stiffness": tuple(np.exp(rng.uniform(np.log(500.0), np.log(12000.0), 3))),
        "force_max": tuple(np.exp(rng.uniform(np.log(5.0), np.log(300.0), 3))),
        "range": tuple(rng.uniform(0.002, 0.030, 3)),
        "reset": bool(rng.integers(2)),
        "target": (rng.uniform(0.0, 0.2), rng.uniform(-0.1, 0.1), rng.uniform(-0.005, 0.06)),
    }
    return Step.model_validate({"time": time, "name": kind, kind: values[kind]})
