"""The compiled chain of an imperfect robot (cpp/plant/imperfect_robot.cpp), made from its configuration."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from pliant._plant import ImperfectRobot
from pliant.sampling import kept_share, whole_periods
from pliant.simulation.imperfections.config import Imperfections
from pliant.simulation.imperfections.draws import Draws
from pliant.simulation.imperfections.link_config import per_joint
from pliant.simulation.seeding import generator
from pliant.spatial import Array, as_vector

GEARS = "actuation.noise"


@dataclass(frozen=True, slots=True)
class Sizes:
    """Of a chain."""

    n: int
    """joints"""
    sensors: tuple[str, ...]
    """frames with a force/torque sensor"""
    ticks: int
    """corrections of the torque loop in a control period"""
    inner: int
    """steps of the perfect robot in each"""
    inner_period: float
    """s of one of them"""


def chain_of(config: Imperfections, sizes: Sizes) -> ImperfectRobot:
    """The chain.

    Raises:
        ConfigError: a delay that is not a whole number of corrections. ShapeError: a value per joint that does not fit.
    """
    n, gears, sensing, ripple = sizes.n, config.actuation, config.sensing, config.ripple
    tick, loop = config.torque_loop.period, config.torque_loop
    late = whole_periods(sensing.delay, tick, "sensing delay")
    torque_delay = sensing.delay if sensing.delay_torque is None else sensing.delay_torque
    late_torque = whole_periods(torque_delay, tick, "delay of the torque sensors")
    late_force = whole_periods(sensing.delay_force, tick, "delay of the force signal")
    peak = np.inf if gears.peak_torque is None else gears.peak_torque
    noise = _noise(config, n)
    return ImperfectRobot(
        n=n,
        frames=len(sizes.sensors),
        ticks=sizes.ticks,
        inner=sizes.inner,
        under_way=whole_periods(config.computation_delay, tick, "computation delay"),
        limit=[peak] * n,
        dry=as_vector(gears.dry_friction, n, "dry_friction").tolist(),
        viscous=as_vector(gears.viscous_friction, n, "viscous_friction").tolist(),
        noise=noise[GEARS].tolist(),
        friction_velocity=gears.friction_velocity,
        kept=0.0 if gears.bandwidth is None else kept_share(gears.bandwidth, sizes.inner_period),
        loop=[loop.period, loop.gain_p, loop.gain_i, loop.gain_d],
        ripple=[ripple.amplitude, ripple.frequency, ripple.speed, ripple.force],
        late=[late, late_torque, late_force],
        noise_q=noise["sensing.q"].tolist(),
        noise_v=noise["sensing.v"].tolist(),
        noise_torque=noise["sensing.torque"].tolist(),
        noise_wrench=[sensing.noise_force, sensing.noise_moment],
    )


def draws_of(config: Imperfections, sizes: Sizes, seed: int) -> Draws:
    """The random numbers of the chain."""
    noise = _noise(config, sizes.n)
    felt = max(config.sensing.noise_force, config.sensing.noise_moment) > 0.0
    wrenches = wrench_sources(sizes.sensors)
    widths = {name: sizes.n * (sizes.inner if name == GEARS else 1) for name in noise} | dict.fromkeys(wrenches, 6)
    noisy = {name: bool(values.any()) for name, values in noise.items()} | dict.fromkeys(wrenches, felt)
    return Draws.start(seed, widths, noisy, sizes.ticks)


def drawn_once(config: Imperfections, n: int, seed: int) -> Mapping[str, Array]:
    """Random values of a run, each (n,): gain and bias of the gears, of the torque sensors."""
    mismatch = generator(seed, "sensing.mismatch")
    return {
        "gain": generator(seed, "actuation.gain").uniform(*config.actuation.gain, n),
        "bias": generator(seed, "actuation.bias").uniform(*config.actuation.bias, n),
        "sensor_gain": 1.0 + config.sensing.torque_gain_error * mismatch.uniform(-1.0, 1.0, n),
        "sensor_offset": config.sensing.torque_offset * mismatch.uniform(-1.0, 1.0, n),
    }


def wrench_sources(sensors: Sequence[str]) -> list[str]:
    """Where the noise of each force/torque sensor comes from."""
    return [f"sensing.wrench.{frame}" for frame in sensors]


def _noise(config: Imperfections, n: int) -> dict[str, Array]:
    """Source → standard deviations (n,), in the order of the columns."""
    s = config.sensing
    found = {GEARS: as_vector(config.actuation.noise, n, "noise")}
    for name in ("q", "v", "torque"):
        value = getattr(s, f"noise_{name}")
        found[f"sensing.{name}"] = per_joint(value, n, f"noise_{name}", fitted=s.fit_joints)
    return found
