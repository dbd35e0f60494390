"""Objects of other people's code, by `module:name` or `file.py:name`."""

from __future__ import annotations

import importlib
import importlib.util
import inspect
import sys
import zlib
from collections.abc import Mapping
from pathlib import Path
from types import ModuleType
from typing import Any

from pliant.entries import Believed, ControllerConfig, ControllerEntry
from pliant.errors import ConfigError, PliantError, options, told
from pliant.interfaces import Controller, Needs
from pliant.robot import Robot


def imported(where: str) -> Any:
    """The object that `module:name` or `file.py:name` names.

    Raises:
        ConfigError: no such module, file or name, or its code fails; one sentence says which.
    """
    module_name, _, name = where.rpartition(":")
    if not module_name or not name:
        raise ConfigError(f"write my_module:Name or my_file.py:Name, got {where!r}")
    module = _from_file(Path(module_name)) if module_name.endswith(".py") else _from_path(module_name)
    if name not in vars(module):
        public = [key for key in vars(module) if not key.startswith("_")]
        raise ConfigError(f"{module_name} has no {name!r}; {options(public, name)}")
    return vars(module)[name]


def _from_path(name: str) -> ModuleType:
    """A module as `python -c 'import …'` finds it: the current folder counts."""
    here = str(Path.cwd())
    added = here not in sys.path and "" not in sys.path
    if added:
        sys.path.append(here)
    try:
        return importlib.import_module(name)
    except (Exception, SystemExit) as error:
        raise ConfigError(f"module {name!r} cannot be imported: {told(error)}") from error
    finally:
        if added:
            sys.path.remove(here)


def _from_file(path: Path) -> ModuleType:
    """A module from a file, once per process."""
    name = f"pliant_user_{path.stem}_{zlib.crc32(str(path.resolve()).encode()):x}"
    if name in sys.modules:
        return sys.modules[name]
    if not path.is_file():
        raise ConfigError(f"file {path} does not exist; write my_file.py:MyController with a path from here")
    spec = importlib.util.spec_from_file_location(name, path)
    if spec is None or spec.loader is None:
        raise ConfigError(f"file {path} is not Python")
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    try:
        spec.loader.exec_module(module)
    except (Exception, SystemExit) as error:
        del sys.modules[name]
        raise ConfigError(f"file {path} cannot be imported: {told(error)}") from error
    return module


def entry_of(found: Any, name: str) -> ControllerEntry[Any]:
    """The entry that an object stands for: an entry, or a controller class `MyController(robot, config, period)`.

    A class may have a `Config` inside, a `ControllerConfig` whose defaults are its parameters. A field `frame` of it is
    set to the task's first frame where the user does not say otherwise.

    Raises:
        ConfigError: it is neither.
    """
    if isinstance(found, ControllerEntry):
        return found
    if not (inspect.isclass(found) and issubclass(found, Controller)):
        raise ConfigError(f"{name} must be a subclass of pliant.interfaces.Controller or an entry, got {found!r}")
    config: Any = vars(found).get("Config", ControllerConfig)
    if not (inspect.isclass(config) and issubclass(config, ControllerConfig)):
        raise ConfigError(f"{name}.Config must be a subclass of pliant.entries.ControllerConfig, got {config!r}")
    first = (inspect.getdoc(found) or "a controller of your own").splitlines()[0]
    return ControllerEntry(name, first, config(), _Build(found), family="own", suggest=_with_frame)


class _Build:
    """Makes controllers of a class."""

    def __init__(self, kind: Any) -> None:
        self._kind = kind

    def __call__(self, robot: Robot, config: ControllerConfig, period: float) -> Controller[Any]:
        try:
            made: Controller[Any] = self._kind(robot, config, period)
            known = isinstance(made.needs, Needs) and isinstance(made.channels, Mapping)  # pyright: ignore[reportUnnecessaryIsInstance] (somebody's own)
        except PliantError:
            raise
        except (Exception, SystemExit) as error:
            raise ConfigError(f"controller {self._kind.__name__} cannot be made: {told(error)}") from error
        if not known:
            raise ConfigError(f"controller {self._kind.__name__}: needs must be Needs, and channels name → unit")
        return made


def _with_frame(robot: Robot, config: ControllerConfig, believed: Believed) -> ControllerConfig:
    if "frame" not in type(config).model_fields:
        return config
    return config.model_copy(update={"frame": believed.frames[0]})
