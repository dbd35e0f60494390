"""How a package offers its controllers by name: a typed default configuration and a way to build one from it.

Each package with controllers (`controllers`, `mpc`, …) keeps a table of its own; `wiring` merges the tables, so that no
package depends on another.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any, Generic, TypeVar

from pliant.axis_modes import Asked
from pliant.configuration import Config, merged
from pliant.dotted import flat
from pliant.errors import ConfigError, options
from pliant.interfaces import Compensation, Controller, Needs, ReferenceSource
from pliant.robot import Robot
from pliant.rules import Rule
from pliant.signals import ImpedanceTuning
from pliant.surfaces import SurfaceGeometry

_NOTHING: Mapping[str, Any] = MappingProxyType({})


class ControllerConfig(Config):
    """Base of a controller's configuration."""

    def driven_frames(self) -> tuple[str, ...]:
        """Frames that the controller drives whatever the task; empty: those of the task."""
        return ()

    def impedances(self) -> Mapping[str, ImpedanceTuning]:
        """Frame → tuning of the fractal impedances that it describes, which a reference can replace."""
        return _NOTHING

    def whole_tuning(self) -> Any:
        """A frozen value with parameters of the whole controller that a reference can carry; None if there is none."""
        return None


C = TypeVar("C", bound=ControllerConfig)


@dataclass(frozen=True)
class Believed:
    """What a controller may know of a task and of its robot before it starts; it excludes how the real world
    differs."""

    frames: tuple[str, ...]
    """frames with a reference, the most important first"""
    period: float
    """of control, s"""
    oriented: bool = True
    """whether the first frame's orientation is asked for"""
    presses: str | None = None
    """frame from which a force is asked; None: no force is asked for"""
    surface: SurfaceGeometry | None = None
    """the surface that is pressed, as it is believed; None: horizontal"""
    stiffness: float | None = None
    """N/m of that surface's contact; None: nothing is believed of it"""
    damping: float | None = None
    """N·s/m of that surface's contact"""
    compensation: Compensation = "none"
    """what the robot compensates by itself"""
    sensing_delay: float = 0.0
    """age of a reading, s"""
    computation_delay: float = 0.0
    """from a reading to the effect of its command, s"""
    phases: Mapping[str, bool] = field(default_factory=lambda: _NOTHING)
    """name of each phase in the references → whether the frame touches in it; empty: phases mean nothing"""
    tunings: Mapping[str, ImpedanceTuning] = field(default_factory=lambda: _NOTHING)
    """frame → impedance that the references carry"""
    axes: Mapping[str, tuple[Asked, ...]] = field(default_factory=lambda: _NOTHING)
    """phase → what is asked of the three axes of its task, the third along its force; empty: the force alone, and a
    motion beside it"""
    turns: Mapping[str, tuple[bool, ...]] = field(default_factory=lambda: _NOTHING)
    """phase of `axes` → which rotations about the three axes of the first frame are held; without an entry all are"""
    noise_force: float = 0.0
    """N, standard deviation of the force sensor's noise"""

    @property
    def late(self) -> float:
        """s by which the loop is late: its period, the age of a reading, and the time to the effect of a command."""
        return self.period + self.sensing_delay + self.computation_delay


def _always(config: Any) -> bool:
    return True


def _no_advice(robot: Robot, config: Any, believed: Believed) -> tuple[str, ...]:
    return ()


def _needs_nothing(config: Any) -> Needs:
    return Needs()


def _as_it_is(robot: Robot, config: Any, believed: Believed) -> Any:
    return config


def _unfiltered(source: ReferenceSource[Any], robot: Robot, config: Any) -> ReferenceSource[Any]:
    return source


def _no_channels(config: Any, frames: Sequence[str]) -> Mapping[str, str]:
    return _NOTHING


@dataclass(frozen=True)
class ControllerEntry(Generic[C]):
    """A controller that can be chosen by name."""

    name: str
    summary: str
    """one line, for `pliant list controllers`"""
    default: C
    """its default configuration, whose type is the schema"""
    build: Callable[[Robot, C, float], Controller[Any]]
    """robot, configuration, control period in s → controller"""
    advise: Callable[[Robot, C, Believed], tuple[str, ...]] = _no_advice
    """robot, configuration, what is believed of the task → warnings about unsafe parameters, as sentences"""
    family: str = "other"
    """controllers of one family share the type of their configuration"""
    guarantees: str = "–"
    """what holds for its commands, and under which conditions, in a few words"""
    regulates_force: bool = False
    """whether it, with its reference filter, drives the contact force to the desired one"""
    yields: Callable[[C], bool] = _always
    """configuration → whether, where it regulates forces, 0 N are a request as any other force is"""
    needs: Callable[[C], Needs] = _needs_nothing
    """configuration → signals that it needs"""
    suggest: Callable[[Robot, C, Believed], C] = _as_it_is
    """robot, initial configuration, what is believed of the task → a configuration that suits robot and task"""
    rules: tuple[Rule, ...] = ()
    """of what `suggest` changes; of a key the first one counts"""
    fixed: Mapping[str, Any] = field(default_factory=lambda: _NOTHING)
    """values of the configuration that make this controller of its family what it is"""
    filter: Callable[[ReferenceSource[Any], Robot, C], ReferenceSource[Any]] = _unfiltered
    """what stands between the task's references and the controller"""
    filter_channels: Callable[[C, Sequence[str]], Mapping[str, str]] = _no_channels
    """configuration and pressing frames → channel of the filter → unit"""
    planner: str = ""
    """its own planner for targets that jump; empty: the task's planner"""

    def over(self, base: ControllerConfig) -> C:
        """A configuration of the same family with the fixed values of this controller."""
        changed: C = merged(base, self.fixed)  # type: ignore[assignment]  # one family, one type
        return changed

    def changed(self, config: C, changes: Mapping[str, Any]) -> C:
        """A configuration of this controller with a user's changes, nested.

        Raises:
            ConfigError: an unknown key, a bad value, or a change of a fixed value of this controller.
        """
        made = merged(config, changes)
        if merged(made, self.fixed) != made:
            fixed = ", ".join(f"{key} = {value!r}" for key, value in flat(self.fixed).items())
            raise ConfigError(
                f"controller {self.name!r} is defined by {fixed}: with other values it is another controller"
                " (`pliant list controllers`)"
            )
        return made


def merged_entries(*tables: Mapping[str, ControllerEntry[Any]]) -> dict[str, ControllerEntry[Any]]:
    """One table out of several. Raises ConfigError if two offer the same name."""
    merged: dict[str, ControllerEntry[Any]] = {}
    for table in tables:
        for name, entry in table.items():
            if name in merged:
                raise ConfigError(f"two controllers are called {name!r}: give one of them another name")
            merged[name] = entry
    return merged


def find_entry(table: Mapping[str, ControllerEntry[Any]], name: str) -> ControllerEntry[Any]:
    """The entry of a name. Raises ConfigError, with the names there are, if it does not exist."""
    if name not in table:
        raise ConfigError(f"there is no controller {name!r}; {options(table, name)}")
    return table[name]
