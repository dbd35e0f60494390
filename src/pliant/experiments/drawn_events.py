"""Events of a task as the seed of a run draws them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, cast

import numpy as np

from pliant.configuration import validated
from pliant.controllers.profiles import LINEAR_SHARE, linear_range
from pliant.errors import ConfigError
from pliant.references.retuned import TuningChange
from pliant.references.toolpaths.files import read_path
from pliant.signals import ImpedanceTuning
from pliant.simulation.seeding import generator
from pliant.spatial import Array
from pliant.tasks.draws import LogUniform, Normal, OneOf, Uniform, drawn
from pliant.tasks.events import Event

_WAYS = {"uniform": Uniform, "log_uniform": LogUniform, "normal": Normal, "choice": OneOf}
_ROUNDING = 1e-9  # s; times are sums of periods
_MOST = 100_000  # changes of a run


def changes_drawn(index: int, event: Event, seed: int, until: float) -> list[tuple[float, dict[str, Any]]]:
    """(s since the start, key → value) of each change that an event makes.

    Args:
        index: of the event in its task, from 1.
        event: what was asked for.
        seed: of the run.
        until: s, no change is made later.

    Raises:
        ConfigError: a table that is no distribution, or a file of targets that cannot be read.
    """
    rng = _generator(index, seed)
    times = _times(event, rng, until)
    if event.file is not None:
        return _targets(Path(event.file), times[0]) if times else []
    found: list[tuple[float, dict[str, Any]]] = []
    for time in times:
        names = list(event.change)
        if event.pick == "one" and names:
            names = [names[int(rng.integers(len(names)))]]
        found.append((time, {name: _value(index, event.change[name], rng) for name in names}))
    return found


def tunings_drawn(
    events: Sequence[Event], tunings: Mapping[str, ImpedanceTuning], seed: int, until: float
) -> list[TuningChange]:
    """The impedances that the events' factors make of those at the start.

    Args:
        events: of the task.
        tunings: frame → impedance at the start.
        seed: of the run.
        until: s, no change is made later.

    Raises:
        ConfigError: there is a factor and no impedance.
    """
    found: list[TuningChange] = []
    for index, event in enumerate(events, start=1):
        if not event.factor:
            continue
        if not tunings:
            raise ConfigError(f"event {index}: factor scales impedances, and this controller has none")
        rng = _generator(index, seed)
        for time in _times(event, rng, until):
            for frame, tuning in tunings.items():
                factors = {
                    str(name): np.array([drawn(how, rng) for _ in range(tuning.axes)])
                    for name, how in event.factor.items()
                }
                found.append(TuningChange(time, frame, scaled(tuning, factors)))
    return found


def scaled(tuning: ImpedanceTuning, factors: Mapping[str, Array]) -> ImpedanceTuning:
    """An impedance with its values multiplied. F_max is raised to K_0 x_0, x_0 lowered to 0.95 x_b, where needed.

    Args:
        tuning: at the start.
        factors: field → (k,) factor, above zero.
    """
    stiffness, reach, bend = tuning.stiffness * factors.get("stiffness", 1.0), tuning.range, tuning.linear_range
    if "range" in factors or "linear_range" in factors:
        reach = reach * factors.get("range", 1.0)
        bend = np.minimum(linear_range(tuning) * factors.get("linear_range", 1.0), LINEAR_SHARE * reach)
    straight = linear_range(tuning) if bend is None else bend
    bound = np.maximum(tuning.force_max * factors.get("force_max", 1.0), stiffness * straight)
    return ImpedanceTuning(stiffness, bound, reach, bend)


def _generator(index: int, seed: int) -> np.random.Generator:
    return generator(seed, f"event.{index}")


def _times(event: Event, rng: np.random.Generator, until: float) -> list[float]:
    first = drawn(event.time, rng)
    if event.every is None:
        return [first]
    wanted = math.inf if event.count is None else event.count
    count = min((until - first) / event.every - _ROUNDING, wanted)
    if count > _MOST:
        raise ConfigError(f"an event makes at most {_MOST} changes, got {count:.0f}: a larger every, or a count")
    return [first + event.every * place for place in range(max(math.ceil(count), 0))]


def _value(index: int, value: Any, rng: np.random.Generator) -> Any:
    """A value with what is drawn in it drawn."""
    if isinstance(value, list | tuple):
        return [_value(index, one, rng) for one in cast("Sequence[Any]", value)]
    if not isinstance(value, Mapping):
        return value
    way = cast("Mapping[str, Any]", value)
    kind = next((_WAYS[name] for name in way if name in _WAYS), None)
    if kind is None:
        raise ConfigError(f"event {index}: a value is drawn as {{ {' = … }, { '.join(_WAYS)} = … }}, got {value!r}")
    how = validated(kind, way)
    if isinstance(how, OneOf) and isinstance(how.choice[0], bool):
        return how.choice[int(rng.integers(len(how.choice)))]
    return drawn(how, rng)


def _targets(file: Path, first: float) -> list[tuple[float, dict[str, Any]]]:
    read = read_path(file)
    if read.time is None:
        raise ConfigError(f"{file} needs a column `time`: an event's targets come at the times that it gives")
    return [
        (first + time, {"target": target})
        for time, target in zip(read.time.tolist(), read.points.tolist(), strict=True)
    ]
