"""The one table of controllers: those of each package, recipes, and those of other packages.

Another package offers its own through the entry-point group `pliant.controllers` (name = "module:MyController").
Without being installed, a controller is chosen as `my_module:MyController` or `my_file.py:MyController`.
"""

from __future__ import annotations

from functools import cache
from importlib.metadata import entry_points
from typing import Any

from pliant.controllers.registry import CONTROLLERS
from pliant.entries import ControllerEntry, find_entry, merged_entries
from pliant.errors import ConfigError
from pliant.mpc.registry import CONTROLLERS as PREDICTIVE
from pliant.wiring.entry_group import GROUP
from pliant.wiring.plugins import entry_of, imported
from pliant.wiring.recipes import RECIPES

OWN = merged_entries(CONTROLLERS, PREDICTIVE, RECIPES)
"""name → entry of what is part of pliant"""


def controllers() -> dict[str, ControllerEntry[Any]]:
    """Name → entry of every controller that has a name.

    Entries of installed packages that cannot be used are left out; `broken_controllers` has the reasons.
    """
    return _offered()[0]


def broken_controllers() -> dict[str, str]:
    """Name of each controller that an installed package offers and that cannot be used → why not."""
    return _offered()[1]


@cache
def _offered() -> tuple[dict[str, ControllerEntry[Any]], dict[str, str]]:
    found, broken = dict(OWN), dict[str, str]()
    for point in entry_points(group=GROUP):
        package = "an installed package" if point.dist is None else f"the package {point.dist.name!r}"
        try:
            if point.name in found:
                raise ConfigError("there is another controller of that name")
            found[point.name] = entry_of(imported(point.value), point.name)
        except ConfigError as error:
            broken[point.name] = f"controller {point.name!r} ({point.value}) of {package} cannot be used: {error}"
    return found, broken


def find_controller(name: str) -> ControllerEntry[Any]:
    """The controller of a name, or of `module:Class` or `file.py:Class`.

    Raises:
        ConfigError: there is none, with the names there are.
    """
    if ":" in name:
        return entry_of(imported(name), name)
    own = OWN.get(name)  # searching all installed packages takes time
    if own is None and name in broken_controllers() and name not in controllers():
        raise ConfigError(broken_controllers()[name])
    return own or find_entry(controllers(), name)
