"""Names that are imported on first use, so that `import pliant` is fast."""

from __future__ import annotations

import importlib
import sys
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
