"""The functions that a module offers."""

from __future__ import annotations

import inspect
from types import ModuleType


def functions_of(*modules: ModuleType) -> set[str]:
    """Names of the public functions that modules define themselves."""
    return {
        name
        for module in modules
        for name, found in inspect.getmembers(module, inspect.isfunction)
        if found.__module__ == module.__name__ and not name.startswith("_")
    }
