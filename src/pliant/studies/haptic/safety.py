"""Warnings about an unsafe configuration, before a run: gains, actuators, forces, and targets out of reach."""

from __future__ import annotations

import math

import numpy as np

from pliant.controllers.advice import advise, sentences, smallest_inertia
from pliant.controllers.profiles import ForceProfile
from pliant.references.planners.workspace import Workspace, workspace_of
from pliant.robot import Robot
from pliant.signals import ImpedanceTuning
from pliant.spatial import Array
from pliant.studies.haptic.config import FAMILY, HapticCaseConfig
from pliant.studies.haptic.scene import FOOT_RADIUS, touching_height
from pliant.studies.haptic.script import UserSettings, user_settings

_SAFE_GAIN = 0.5
"""k_I over the actuators' bandwidth in rad/s: no limit cycle, neither on a rigid floor nor on a soft ball"""


def warnings_of(config: HapticCaseConfig, robot: Robot) -> tuple[str, ...]:
    """Sentences, each with the value that would be safe; none if all is well."""
    found: list[str] = []
    found += _gains(config, robot)
    found += _exploration_gain(config)
    workspace = workspace_of(robot, config.frame)
    for time, settings in user_settings(config, config.exploration):
        found += [
            f"t = {time:g} s: {text}"
            for text in [*_force_bounds(settings), *_distance(settings, workspace), *_offsets(settings, config)]
        ]
    return tuple(dict.fromkeys(found))


def _gains(config: HapticCaseConfig, robot: Robot) -> list[str]:
    """ω T_s, the actuators' bandwidth and the leak at the knee, at the start and at every tuning of the steps."""
    bandwidth = config.hardware.bandwidth
    q = robot.home if config.start is None else np.array(config.start)
    inertia = _inertia(robot, config.frame, q)
    tunings: list[ImpedanceTuning] = []
    for _, settings in user_settings(config, config.exploration):
        if all(settings.tuning is not known for known in tunings):
            tunings.append(settings.tuning)
    found: list[str] = []
    for tuning in tunings:
        found += sentences(
            advise(
                tuning,
                config.period,
                inertia,
                shape=config.impedance.profile,
                torque_bandwidth=None if bandwidth is None else 2.0 * math.pi * bandwidth,
                speed=config.planner.speed,
            )
        )
    return found


def _inertia(robot: Robot, frame: str, q: Array) -> Array:
    return smallest_inertia(robot, frame, q)[:3]


def _exploration_gain(config: HapticCaseConfig) -> list[str]:
    entry = config.entry
    adaptive = entry.family == FAMILY and "exploration" not in entry.fixed  # one that is fixed is printed, or none
    if config.hardware.bandwidth is None or not adaptive:
        return []
    safe = _SAFE_GAIN * 2.0 * math.pi * config.hardware.bandwidth
    if config.exploration.gain <= safe * (1.0 + 1e-9):
        return []
    return [
        f"the exploration corrects the force at {config.exploration.gain:g} /s, too fast for actuators of"
        f" {config.hardware.bandwidth:g} Hz; safe: exploration.gain ≤ {safe:.3g} /s"
    ]


def _force_bounds(settings: UserSettings) -> list[str]:
    """Forces beyond F_max: the exploration clamps them and reports the rest."""
    found: list[str] = []
    for axis, force, bound in zip("xyz", settings.force, settings.tuning.force_max, strict=True):
        if abs(force) > bound:
            found.append(
                f"{force:g} N along {axis} exceed F_max = {bound:g} N and are clamped to it; safe: |F_d| ≤ {bound:g} N"
            )
    return found


def _distance(settings: UserSettings, workspace: Workspace) -> list[str]:
    target = np.array(settings.target)
    nearest = workspace.nearest(target)
    if nearest is target:
        return []
    return [
        f"the target {list(settings.target)} m lies {1e3 * np.linalg.norm(target - nearest):.0f} mm out of reach and is"
        f" brought back; safe: {np.round(nearest, 4).tolist()} m"
    ]


def _offsets(settings: UserSettings, config: HapticCaseConfig) -> list[str]:
    """Forces along z that the bound x_b of the offset does not allow on what lies below the target."""
    below = _surface_below(settings.target, config)
    F_d, F_max = settings.force[2], float(settings.tuning.force_max[2])
    if below is None or config.random or not 0.0 < F_d <= F_max:
        return []
    depth, K_e = below
    K_0, x_b = float(settings.tuning.stiffness[2]), float(settings.tuning.range[2])
    most = reachable_force(depth, K_e, profile_along(2, settings.tuning, config), x_b)
    if most >= F_d or K_0 == 0.0:
        return []
    enough = F_d * (K_e + K_0) / (K_e * K_0) - depth
    return [
        f"{F_d:g} N along z are out of reach, {most:.3g} N is all that x_b = {x_b:g} m allows there;"
        f" safe: |F_d| ≤ {most:.3g} N or range z ≥ {enough:.3g} m"
    ]


def _surface_below(target: tuple[float, float, float], config: HapticCaseConfig) -> tuple[float, float] | None:
    """Depth of a target below where the foot would touch, m, and stiffness of what is there, N/m, where it is known."""
    x, y, z = target
    box, ball, floor = config.environment.box, config.environment.ball, config.environment.floor
    if ball is not None and math.hypot(x - ball.position[0], y - ball.position[1]) < 0.3 * ball.radius:
        return ball.position[2] + ball.radius + FOOT_RADIUS - z, ball.material.stiffness
    if box is not None or ball is not None or floor is None:
        return None  # beside things, what the foot meets first depends on its way
    depth = touching_height(floor, x, y, FOOT_RADIUS) - z
    return (depth, floor.material.stiffness) if depth > 0.0 else None


def profile_along(axis: int, tuning: ImpedanceTuning, config: HapticCaseConfig) -> ForceProfile:
    """The profile of one axis of the foot's impedance."""
    one = slice(axis, axis + 1)
    bend = None if tuning.linear_range is None else tuning.linear_range[one]
    own = ImpedanceTuning(tuning.stiffness[one], tuning.force_max[one], tuning.range[one], bend)
    return ForceProfile.of(own, config.impedance.profile)


def reachable_force(depth: float, surface_stiffness: float, profile: ForceProfile, bound: float) -> float:
    """The largest force on a surface at rest: K_e d = F(x_b + p − d), d how deep the surface yields.

    Args:
        depth: p of the target below the surface, m.
        surface_stiffness: K_e, N/m.
        profile: F, of one axis.
        bound: x_b of the offset, m.

    Returns:
        N.
    """
    low, high = 0.0, max(bound + depth, 0.0)
    for _ in range(60):  # the profile is monotone: halving finds where both are equal
        middle = 0.5 * (low + high)
        yields = float(profile.magnitude(np.array([bound + depth - middle]))[0]) > surface_stiffness * middle
        low, high = (middle, high) if yields else (low, middle)
    return surface_stiffness * low
