"""A delay gives back exactly what it was given, exactly so many steps later."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pliant.errors import ConfigError
from pliant.sampling import whole_periods
from pliant.simulation.imperfections.delay import Delay


@given(periods=st.integers(0, 20), length=st.integers(1, 60))
def test_every_value_comes_out_exactly_so_many_steps_later(periods: int, length: int) -> None:
    delay: Delay[int] = Delay(periods)
    queue = delay.init(-1)
    out = []
    for value in range(length):
        got, queue = delay.step(value, queue)
        out.append(got)
        assert len(queue) == periods
    assert out == ([-1] * periods + list(range(length)))[:length]


def test_the_queue_passed_in_is_not_changed() -> None:
    delay: Delay[int] = Delay(2)
    queue = delay.init(0)
    delay.step(1, queue)
    assert queue == (0, 0)


def test_durations_must_be_whole_multiples() -> None:
    assert whole_periods(5e-3, 1e-3, "delay") == 5
    assert whole_periods(0.0, 1e-3, "delay") == 0
    with pytest.raises(ConfigError, match=r"whole multiple of 0\.001 s"):
        whole_periods(2.5e-3, 1e-3, "delay")
    with pytest.raises(ConfigError, match="not negative"):
        whole_periods(-1e-3, 1e-3, "delay")
    with pytest.raises(ConfigError, match="negative"):
        Delay(-1)
