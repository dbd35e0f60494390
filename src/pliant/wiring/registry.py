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
from pliant.mpc.registry import CONTROLLERS as PREDICTIVE
from pliant.wiring.plugins import entry_of, imported
from pliant.wiring.recipes import RECIPES

GROUP = "pliant.controllers"
_OWN = merged_entries(CONTROLLERS, PREDICTIVE, RECIPES)


@cache
def controllers() -> dict[str, ControllerEntry[Any]]:
    """Name → entry of every controller that has a name.

    Raises:
        ConfigError: two have the same name, or an installed package offers something that is not a controller.
    """
    offered = {point.name: entry_of(imported(point.value), point.name) for point in entry_points(group=GROUP)}
    return merged_entries(_OWN, offered)


def find_controller(name: str) -> ControllerEntry[Any]:
    """The controller of a name, or of `module:Class` or `file.py:Class`.

    Raises:
        ConfigError: there is none, with the names there are.
    """
    if ":" in name:
        return entry_of(imported(name), name)
    own = _OWN.get(name)  # looking through every installed package takes a moment
    return own or find_entry(controllers(), name)
