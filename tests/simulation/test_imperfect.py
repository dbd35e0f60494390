"""The whole chain round a plant that can be computed by hand: a mass per joint, pushed by its torque."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest
from pydantic import BaseModel

from pliant.errors import ConfigError
from pliant.interfaces import Plant
from pliant.signals import Command, Measurement
from pliant.simulation.imperfections.actuation import ActuationConfig
from pliant.simulation.imperfections.config import Imperfections
from pliant.simulation.imperfections.plant import ImperfectPlant
from pliant.simulation.imperfections.ripple import RippleConfig
from pliant.simulation.imperfections.sensing import SensingConfig
from pliant.simulation.imperfections.torque_loop import TorqueLoopConfig
from pliant.simulation.plant import JointEffects

N = 6


@dataclass(frozen=True)
class Masses(Plant[Measurement]):
    """Inertias without gravity; the state is the true measurement."""

    period: float = 1e-3
    inertia: float = 1.0
    """kg m²"""

    def init(self) -> tuple[Measurement, Measurement]:
        start = Measurement(0.0, np.zeros(N), np.zeros(N), np.zeros(N), np.zeros(N), {"tool": np.arange(6.0)})
        return start, start

    def step(self, command: Command, world: Measurement) -> tuple[Measurement, Measurement]:
        v = world.v + self.period * command.torque / self.inertia
        q = world.q + self.period * v
        after = replace(
            world, time=world.time + self.period, q=q, v=v, torque=command.torque, torque_sent=command.torque
        )
        return after, after


def command(torque: float | np.ndarray, time: float = 0.0) -> Command:
    return Command(time, np.full(N, torque) if np.isscalar(torque) else np.asarray(torque), np.zeros(N))


def drive(plant: ImperfectPlant, torques: list[float]) -> list[Measurement]:
    measurement, world = plant.init()
    log = [measurement]
    for torque in torques:
        measurement, world = plant.step(command(torque, measurement.time), world)
        log.append(measurement)
    return log


def test_perfect_is_the_plant_inside_bit_for_bit() -> None:
    rng = np.random.default_rng(0)
    inner, chain = Masses(), ImperfectPlant(Masses(), Imperfections.perfect())
    a, inner_world = inner.init()
    b, world = chain.init()
    for _ in range(50):
        torque = rng.standard_normal(N)
        a, inner_world = inner.step(command(torque), inner_world)
        b, world = chain.step(command(torque), world)
        for name in ("q", "v", "torque", "torque_sent"):
            assert np.array_equal(getattr(a, name), getattr(b, name)), name
        assert np.array_equal(a.wrenches["tool"], b.wrenches["tool"])
        assert a.time == pytest.approx(b.time)


@pytest.mark.parametrize("ticks", [0, 1, 5])
def test_a_command_takes_effect_exactly_the_computation_delay_later(ticks: int) -> None:
    plant = ImperfectPlant(Masses(), Imperfections(computation_delay=ticks * 1e-3), holding_torque=np.full(N, 0.5))
    log = drive(plant, [10.0 + k for k in range(20)])
    sent = [m.torque_sent[0] for m in log[1:]]
    assert sent == ([0.5] * ticks + [10.0 + k for k in range(20)])[:20]
    assert [m.torque[0] for m in log[1:]] == sent


def test_control_at_500_hz_over_a_torque_loop_at_1_khz_over_physics_at_4_khz() -> None:
    plant = ImperfectPlant(Masses(2.5e-4), Imperfections(computation_delay=5e-3), period=2e-3)
    log = drive(plant, [1.0] * 10)
    assert [m.time for m in log] == pytest.approx([2e-3 * k for k in range(11)])
    # 5 ms are two and a half control periods: the first command rules half of the third one.
    assert [m.torque_sent[0] for m in log[1:5]] == pytest.approx([0.0, 0.0, 0.5, 1.0])
    assert log[-1].v[0] == pytest.approx(20e-3 - 5e-3)


def test_the_torque_loop_removes_bias_and_gain_error_inside_the_whole_chain() -> None:
    config = Imperfections.p3().model_copy(update={"computation_delay": 0.0})
    without = config.model_copy(update={"torque_loop": TorqueLoopConfig()})
    means = []
    for case in (config, without):
        log = drive(ImperfectPlant(Masses(inertia=1e6), case, seed=2), [20.0] * 4000)
        late = np.array([m.torque - m.torque_sent for m in log[2000:]])
        means.append(float(np.abs(late.mean(axis=0)).max()))
    assert means[0] < 0.02
    assert means[1] > 0.5


def test_the_peak_torque_is_visible_in_what_was_sent() -> None:
    inner = Masses()
    config = Imperfections.p0_experiment4().model_copy(update={"joint_damping": 0.0})
    log = drive(ImperfectPlant(inner, config), [100.0] * 100)
    assert all(m.torque_sent[0] == 40.0 for m in log[1:])
    rise = np.array([m.torque[0] for m in log[1:]])
    t = 1e-3 * np.arange(1, 101)
    assert np.allclose(rise, 40.0 * (1.0 - np.exp(-2.0 * np.pi * 20.0 * t)), rtol=1e-9)


def test_gears_act_before_the_torque_sensor_and_reading_noise_does_not_act_on_the_plant() -> None:
    geared = Imperfections(actuation=ActuationConfig(gain=(0.9, 0.9), bias=(1.0, 1.0)))
    noisy = Imperfections(sensing=SensingConfig(noise_torque=1.0, noise_q=0.1, noise_v=0.1))
    log = drive(ImperfectPlant(Masses(), geared), [10.0] * 5)
    assert log[-1].torque[0] == pytest.approx(0.9 * 10.0 + 1.0)
    assert log[-1].torque_sent[0] == 10.0
    plant = ImperfectPlant(Masses(), noisy, seed=1)
    measurement, world = plant.init()
    for _ in range(10):
        measurement, world = plant.step(command(1.0), world)
    assert world.inner.v[0] == pytest.approx(10e-3)
    assert abs(measurement.torque - 1.0).max() > 0.1


def test_the_same_seed_gives_the_same_log_bit_for_bit() -> None:
    logs = [drive(ImperfectPlant(Masses(), Imperfections.p3(), seed=s), [1.0, -1.0] * 50) for s in (8, 8, 9)]
    for a, b in zip(logs[0], logs[1], strict=True):
        assert np.array_equal(a.q, b.q)
        assert np.array_equal(a.torque, b.torque)
        assert np.array_equal(a.wrenches["tool"], b.wrenches["tool"])
    assert not np.array_equal(logs[0][-1].torque, logs[2][-1].torque)


def test_init_starts_the_same_run_again() -> None:
    plant = ImperfectPlant(Masses(), Imperfections.p3(), seed=8)
    first, second = drive(plant, [1.0] * 30), drive(plant, [1.0] * 30)
    assert all(np.array_equal(a.q, b.q) for a, b in zip(first, second, strict=True))


def test_ripple_reaches_the_force_measurement_only() -> None:
    config = Imperfections(ripple=RippleConfig(amplitude=5.0))
    plant = ImperfectPlant(Masses(), config)
    measurement, world = plant.init()
    for _ in range(10):
        measurement, world = plant.step(command(100.0), world)
    assert not np.allclose(measurement.wrenches["tool"], np.arange(6.0))
    assert np.array_equal(world.inner.wrenches["tool"], np.arange(6.0))


def test_joint_damping_must_be_in_the_plant_inside() -> None:
    config = Imperfections.p0_experiment4()
    with pytest.raises(ConfigError, match=r"JointEffects\(damping=11\.46\)"):
        ImperfectPlant(Masses(), config)

    class Damped(Masses):
        joints = JointEffects(damping=11.46)

    ImperfectPlant(Damped(), config)


def test_periods_must_be_whole_multiples() -> None:
    with pytest.raises(ConfigError, match="control period must be a whole multiple"):
        ImperfectPlant(Masses(), Imperfections(), period=1.5e-3)
    with pytest.raises(ConfigError, match="torque loop's period must be a whole multiple"):
        ImperfectPlant(Masses(3e-4), Imperfections())
    with pytest.raises(ConfigError, match="computation delay"):
        ImperfectPlant(Masses(), Imperfections(computation_delay=2.5e-3))


def test_every_value_of_the_configuration_has_a_unit_a_description_and_a_default() -> None:
    def check(model: type, path: str = "") -> int:
        count = 0
        for name, info in model.model_fields.items():
            if isinstance(info.default, BaseModel):
                count += check(type(info.default), f"{path}{name}.")
                continue
            assert info.description, path + name
            assert info.json_schema_extra["unit"], path + name
            assert not info.is_required(), path + name
            count += 1
        return count

    assert check(Imperfections) > 20
