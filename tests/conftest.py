"""Shared fixtures: robots, and one settings profile for every property test."""

from __future__ import annotations

import pytest
from hypothesis import HealthCheck, settings
from xdist.remote import Producer
from xdist.scheduler import LoadFileScheduling

from pliant.robot import Robot
from pliant.robots import CATALOGUE, is_available

settings.register_profile(
    "pliant", deadline=None, max_examples=60, suppress_health_check=[HealthCheck.too_slow], derandomize=True
)
settings.load_profile("pliant")


class BrowsersTogether(LoadFileScheduling):
    """The tests of a file run in one process, and those of all files that drive a browser in one and the same: a
    second browser would take the processor from the first."""

    def _split_scope(self, nodeid: str) -> str:
        file = super()._split_scope(nodeid)
        return "browser" if _drives_browser(file) else file


def _drives_browser(file: str) -> bool:
    return file.endswith("browser.py")


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Producer) -> BrowsersTogether | None:
    return BrowsersTogether(config, log) if config.getvalue("dist") == "loadfile" else None


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Browsers come first and then files with studies: they take longest, and so the processes end at about the same
    time."""
    studies = {item.path for item in items if item.get_closest_marker("study")}
    items.sort(key=lambda item: (not _drives_browser(item.path.name), item.path not in studies))


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
