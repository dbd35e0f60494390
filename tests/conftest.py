"""Shared fixtures: robots, and one settings profile for every property test."""

from __future__ import annotations

import pytest
from hypothesis import HealthCheck, settings

from pliant.robot import Robot
from pliant.robots import CATALOGUE, is_available

settings.register_profile(
    "pliant", deadline=None, max_examples=60, suppress_health_check=[HealthCheck.too_slow], derandomize=True
)
settings.load_profile("pliant")
_APART = 8  # files from one that drives a browser to the next


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Files with studies come first: they take longest, and so the processes end at about the same time.

    Those that drive a browser lie apart: each needs the whole machine, and they wait for each other.
    """
    studies = {item.path for item in items if item.get_closest_marker("study")}
    browsers = {item.path for item in items if "browser" in getattr(item, "fixturenames", ())}
    files = sorted(dict.fromkeys(item.path for item in items), key=lambda path: path not in studies)
    order = [path for path in files if path not in browsers]
    for number, path in enumerate(path for path in files if path in browsers):
        order.insert(_APART * number, path)
    items.sort(key=lambda item: order.index(item.path))


@pytest.fixture(scope="session")
def lwr4() -> Robot:
    return Robot.load("lwr4")


@pytest.fixture(scope="session")
def leg3() -> Robot:
    return Robot.load("leg3")


@pytest.fixture(scope="session")
def iiwa14() -> Robot:
    return Robot.load("iiwa14")


def available_robots() -> list[str]:
    """Catalogue names whose files are installed."""
    return [name for name, entry in CATALOGUE.items() if is_available(entry)]
