"""Names that are imported on first use, so that `import pliant` is fast."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Mapping
from types import ModuleType
from typing import Any


def make_callable(package: str, module: str, function: str) -> None:
    """Lets a package be called: `pliant.controllers` is the package of controllers, `pliant.controllers()` lists all.

    Args:
        package: name of the package that is being imported.
        module, function: what a call of the package runs; imported by the first call.
    """

    class CallablePackage(ModuleType):
        def __call__(self) -> Any:
            return vars(importlib.import_module(module))[function]()

    sys.modules[package].__class__ = CallablePackage


def first_use(package: str, where: Mapping[str, str], name: str) -> Any:
    """A name of a package that its `__getattr__` was asked for; from now on the package has it.

    Args:
        package: name of the package.
        where: name → module that has it.
        name: what was asked for.

    Raises:
        AttributeError: the package has no such name.
    """
    if name not in where:
        raise AttributeError(f"module {package!r} has no attribute {name!r}")
    value = vars(importlib.import_module(where[name]))[name]
    setattr(sys.modules[package], name, value)
    return value
