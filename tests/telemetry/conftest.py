"""Ticks that several files of tests record."""

from __future__ import annotations

import pytest

from pliant.signals import Tick
from tests.telemetry.ticks import make_tick


@pytest.fixture(scope="module")
def ticks() -> list[Tick]:
    return [make_tick(k) for k in range(1300)]  # more than two blocks
