"""Names, units and shapes of the channels of a log, and where each one sits in a `Tick`.

measurement/…  estimate/…  reference/…  command/…  truth/…      the signals
everything else                                                  diagnostics of commands and references, as named there
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from fnmatch import fnmatchcase

import numpy as np

from pliant.errors import ConfigError, ShapeError
from pliant.signals import TaskReference, Tick
from pliant.telemetry.channels import Channel, Key, Path, PlacedChannel
from pliant.telemetry.contact_channels import contact_channels
from pliant.telemetry.info import RunInfo

SIGNALS = ("measurement", "estimate", "reference", "command", "truth")
"""First parts of channel names that diagnostics may not take over."""

_JOINT, _JOINT_RATE, _TORQUE = "rad", "rad/s", "N·m"
_WRENCH, _TWIST, _ACCELERATION = "N, N·m", "m/s, rad/s", "m/s², rad/s²"
_TUNING_UNITS = {
    "stiffness": "N/m, N·m/rad",
    "force_max": "N, N·m",
    "range": "m, rad",
    "linear_range": "m, rad",
}


DIAGNOSTICS = (
    Channel("*energy", "J"),
    Channel("*energy_*", "J"),
    Channel("energy/*", "J"),
    Channel("*power", "W"),
    Channel("*wrench", _WRENCH),
    Channel("*torque", _TORQUE),
)
"""Default units of diagnostics; a recorder's own table has priority."""


def channels_of(tick: Tick, info: RunInfo, units: Sequence[Channel] = ()) -> list[PlacedChannel]:
    """The channels of ticks like this one: arrays of the signals, arrays of diagnostics, scalars.

    Args:
        tick: an example.
        info: for the names of the joints.
        units: table of units of diagnostics; names may be patterns, the first that fits counts.

    Raises:
        ConfigError: a diagnostic has the name of another channel.
        ShapeError: a diagnostic is neither a number nor an array of numbers.
    """
    joints = joint_labels(info, tick.measurement.q.shape[0])
    arrays = [*_fixed(tick, joints), *_wrenches(tick), *_tasks(tick), *_truth(tick, joints)]
    surfaces, contacts = contact_channels(tick.estimate)
    arrays += surfaces
    scalars: list[PlacedChannel] = []
    for name in ("command", "reference"):
        more_arrays, more_scalars = _diagnostics(tick, name, (*units, *DIAGNOSTICS))
        arrays += more_arrays
        scalars += more_scalars
    scalars.append(PlacedChannel(("guard",), Channel("guard/fault", "1")))
    for frame in tick.estimate.contacts:
        path: Path = ("estimate", "contacts", Key(frame))
        scalars.append(PlacedChannel(path, Channel(f"estimate/{frame}/contact", "1")))
    found = [*arrays, *scalars, *contacts]
    _check_unique([placed.channel.name for placed in found])
    return found


def joint_labels(info: RunInfo, n: int) -> tuple[str, ...]:
    """(n,) names of the joints."""
    return info.joints if len(info.joints) == n else tuple(f"joint_{i + 1}" for i in range(n))


def axis_labels(size: int) -> tuple[str, ...]:
    """Names of the entries of a task-space vector."""
    spatial = ("x", "y", "z", "rx", "ry", "rz")
    return spatial[:size] if size in (3, 6) else tuple(str(i) for i in range(size))


def _fixed(tick: Tick, joints: tuple[str, ...]) -> list[PlacedChannel]:
    fields = [
        ("measurement", "q", _JOINT),
        ("measurement", "v", _JOINT_RATE),
        ("measurement", "torque", _TORQUE),
        ("measurement", "torque_sent", _TORQUE),
        ("estimate", "q", _JOINT),
        ("estimate", "v", _JOINT_RATE),
        ("estimate", "torque", _TORQUE),
        ("estimate", "torque_sent", _TORQUE),
        ("command", "torque", _TORQUE),
        ("command", "clamped", _TORQUE),
    ]
    if tick.estimate.disturbance is not None:
        fields.append(("estimate", "disturbance", _TORQUE))
    if tick.reference.posture is not None:
        fields.append(("reference", "posture", _JOINT))
    return [
        PlacedChannel((signal, field), Channel(f"{signal}/{field}", unit, (len(joints),), joints))
        for signal, field, unit in fields
    ]


def _wrenches(tick: Tick) -> list[PlacedChannel]:
    found: list[PlacedChannel] = []
    for signal in ("measurement", "estimate", "truth"):
        part = getattr(tick, signal)
        for frame in part.wrenches if part is not None else ():
            channel = Channel(f"{signal}/{frame}/wrench", _WRENCH, (6,), axis_labels(6))
            found.append(PlacedChannel((signal, "wrenches", Key(frame)), channel))
    return found


def _tasks(tick: Tick) -> list[PlacedChannel]:
    return [placed for index, task in enumerate(tick.reference.tasks) for placed in _task(index, task)]


def _task(index: int, task: TaskReference) -> list[PlacedChannel]:
    fields = (("position", "m", 3), ("velocity", _TWIST, 6), ("acceleration", _ACCELERATION, 6), ("wrench", _WRENCH, 6))
    path: Path = ("reference", "tasks", index)
    named = f"reference/{task.frame}"
    found = [
        PlacedChannel((*path, name), Channel(f"{named}/{name}", unit, (k,), axis_labels(k))) for name, unit, k in fields
    ]
    if task.tuning is not None:
        k = task.tuning.axes
        for name, unit in _TUNING_UNITS.items():
            if getattr(task.tuning, name) is not None:
                channel = Channel(f"{named}/{name}", unit, (k,), axis_labels(k))
                found.append(PlacedChannel((*path, "tuning", name), channel))
    if task.rotation is not None:
        found.append(PlacedChannel((*path, "rotation"), Channel(f"{named}/rotation", "1", (3, 3))))
    return found


def _truth(tick: Tick, joints: tuple[str, ...]) -> list[PlacedChannel]:
    truth = tick.truth
    if truth is None:
        return []
    fields = [("q", _JOINT), ("v", _JOINT_RATE), ("torque", _TORQUE)]
    if truth.limit_excess is not None:
        fields.append(("limit_excess", _JOINT))
    found = [
        PlacedChannel(("truth", name), Channel(f"truth/{name}", unit, (len(joints),), joints)) for name, unit in fields
    ]
    for field, name, unit, shape in (
        ("positions", "{}/position", "m", (3,)),
        ("rotations", "{}/rotation", "1", (3, 3)),
        ("objects", "objects/{}/pose", "m, 1", (7,)),
    ):
        for key in getattr(truth, field):
            channel = Channel(f"truth/{name.format(key)}", unit, shape, _labels(shape))
            found.append(PlacedChannel(("truth", field, Key(key)), channel))
    return found


def _labels(shape: tuple[int, ...]) -> tuple[str, ...]:
    return ("x", "y", "z", "qw", "qx", "qy", "qz") if shape == (7,) else axis_labels(math.prod(shape))


def _diagnostics(tick: Tick, signal: str, units: Sequence[Channel]) -> tuple[list[PlacedChannel], list[PlacedChannel]]:
    entries = getattr(tick, signal).diagnostics
    if not isinstance(entries, Mapping) or not all(isinstance(name, str) for name in entries):
        raise ShapeError(f"the {signal}'s diagnostics must be a mapping from names to numbers, got {entries!r:.80}")
    arrays: list[PlacedChannel] = []
    scalars: list[PlacedChannel] = []
    for name, value in entries.items():
        sample = np.asarray(value)
        if sample.dtype.kind not in "fiub":
            raise ShapeError(f"diagnostic {name!r} must be a number or an array of numbers, got {type(value).__name__}")
        if name.split("/")[0] in SIGNALS and "/" in name:
            raise ConfigError(
                f"diagnostic {name!r} must not start with one of {', '.join(SIGNALS)}: these name the signals"
            )
        unit, labels = _registered(name, units)
        if not labels and sample.ndim:
            labels = axis_labels(sample.size)
        channel = Channel(name, unit, sample.shape, labels)
        (arrays if sample.ndim else scalars).append(PlacedChannel((signal, "diagnostics", Key(name)), channel))
    return arrays, scalars


def _registered(name: str, units: Sequence[Channel]) -> tuple[str, tuple[str, ...]]:
    for known in units:
        if fnmatchcase(name, known.name):
            return known.unit, known.labels
    return "", ()


def _check_unique(names: list[str]) -> None:
    if len(set(names)) != len(names):
        twice = sorted({name for name in names if names.count(name) > 1})
        raise ConfigError(f"every channel needs a name of its own, used more than once: {', '.join(twice)}")
