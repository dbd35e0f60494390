"""Objects from a user's code, by `module:name` or `file.py:name`."""

from __future__ import annotations

import importlib
import importlib.util
import inspect
import sys
import zlib
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from types import ModuleType
from typing import Any

from pliant.configuration import merged
from pliant.entries import Believed, ControllerConfig, ControllerEntry
from pliant.errors import ConfigError, PliantError, options, told
from pliant.interfaces import Controller, Needs, ReferenceSource
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
        return _guarded(found, name)
    if not (inspect.isclass(found) and issubclass(found, Controller)):
        raise ConfigError(f"{name} must be a subclass of pliant.interfaces.Controller or an entry, got {found!r}")
    config: Any = getattr(found, "Config", ControllerConfig)
    if not (inspect.isclass(config) and issubclass(config, ControllerConfig)):
        raise ConfigError(f"{name}.Config must be a subclass of pliant.entries.ControllerConfig, got {config!r}")
    first = (inspect.getdoc(found) or "a controller of your own").splitlines()[0]
    return ControllerEntry(name, first, config(), _Build(found), family="own", suggest=_with_frame)


def _guarded(entry: ControllerEntry[Any], name: str) -> ControllerEntry[Any]:
    """A user's entry, whose functions return the right type or raise an error of one sentence."""
    parts: dict[str, type] = {"build": Controller, "suggest": ControllerConfig, "filter": ReferenceSource}
    asked = {part: _Promised(name, part, getattr(entry, part), kind) for part, kind in parts.items()}
    return replace(entry, build=_Build(asked["build"]), suggest=asked["suggest"], filter=asked["filter"])


class _Promised:
    """A function of a user's entry. Raises ConfigError: it fails, or returns another type."""

    def __init__(self, name: str, part: str, function: Callable[..., Any], kind: type) -> None:
        self._what, self._function, self._kind = f"controller {name!r}: its {part}", function, kind
        self.__name__ = name

    def __call__(self, *given: Any) -> Any:
        try:
            made = self._function(*given)
        except PliantError:
            raise
        except (Exception, SystemExit) as error:
            raise ConfigError(f"{self._what} fails: {told(error)}") from error
        if not isinstance(made, self._kind):
            raise ConfigError(f"{self._what} must return a {self._kind.__name__}, got {made!r:.80}")
        return made


class _Build:
    """Makes controllers of a class, or by a function."""

    def __init__(self, kind: Any) -> None:
        self._kind = kind

    def __call__(self, robot: Robot, config: ControllerConfig, period: float) -> Controller[Any]:
        try:
            made: Controller[Any] = self._kind(robot, config, period)
            known = isinstance(made.needs, Needs) and _has_units(made.channels)  # pyright: ignore[reportUnnecessaryIsInstance] (somebody's own)
        except PliantError:
            raise
        except (Exception, SystemExit) as error:
            raise ConfigError(f"controller {self._kind.__name__} cannot be made: {told(error)}") from error
        if not known:
            raise ConfigError(f"controller {self._kind.__name__}: needs must be Needs, and channels name → ChannelUnit")
        return made


def _has_units(channels: Any) -> bool:
    return isinstance(channels, Mapping) and all(
        isinstance(name, str) and isinstance(getattr(about, "unit", None), str)
        for name, about in channels.items()  # pyright: ignore[reportUnknownVariableType]
    )


def _with_frame(robot: Robot, config: ControllerConfig, believed: Believed) -> ControllerConfig:
    if "frame" not in type(config).model_fields:
        return config
    return merged(config, {"frame": believed.frames[0]})
