"""A delay gives back exactly what it was given, exactly so many steps later."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pliant.errors import ConfigError
from pliant.sampling import whole_periods
from pliant.signals import Measurement
from pliant.simulation.imperfections.config import Imperfections
from pliant.simulation.imperfections.sensing import SensingConfig
from tests.simulation.scripted import Scripted, readings


@settings(max_examples=60, deadline=None)
@given(
    command=st.integers(0, 20),
    late=st.integers(0, 20),
    torque=st.integers(0, 20),
    force=st.integers(0, 20),
    length=st.integers(1, 60),
)
def test_every_value_comes_out_exactly_so_many_steps_later(
    command: int, late: int, torque: int, force: int, length: int
) -> None:
    sensing = SensingConfig(delay=late * 1e-3, delay_torque=torque * 1e-3, delay_force=force * 1e-3)
    config = Imperfections(computation_delay=command * 1e-3, sensing=sensing)

    def script(tick: int, _: np.ndarray) -> Measurement:
        now = np.array([float(tick)])
        return Measurement(1e-3 * tick, now, now, now, now, {"tool": np.full(6, float(tick))})

    plant = Scripted(script, 1)
    log = readings(config, plant, [np.array([1.0 + k]) for k in range(length)])
    assert [t[0] for t in plant.received] == ([0.0] * command + [1.0 + k for k in range(length)])[:length]
    for tick, reading in enumerate(log):
        assert reading.q[0] == reading.v[0] == max(tick - late, 0)
        assert reading.wrenches["tool"][5] == max(tick - late - force, 0)
        assert reading.torque[0] == max(tick - torque, 0)


def test_durations_must_be_whole_multiples() -> None:
    assert whole_periods(5e-3, 1e-3, "delay") == 5
    assert whole_periods(0.0, 1e-3, "delay") == 0
    with pytest.raises(ConfigError, match=r"whole multiple of 0\.001 s"):
        whole_periods(2.5e-3, 1e-3, "delay")
    with pytest.raises(ConfigError, match="not negative"):
        whole_periods(-1e-3, 1e-3, "delay")
