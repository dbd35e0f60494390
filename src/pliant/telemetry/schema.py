"""Names, units and shapes of the channels of a log, and where each one sits in a `Tick`.

measurement/…  estimate/…  reference/…  command/…  truth/…      the signals
everything else                                                  diagnostics of commands and references, as named there
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from fnmatch import fnmatchcase
from operator import attrgetter, itemgetter
from typing import Any

import numpy as np

from pliant.errors import ConfigError, ShapeError
from pliant.signals import TaskReference, Tick
from pliant.telemetry.channels import Channel, ChannelGroup, Groups
from pliant.telemetry.contact_channels import contact_groups
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


def signature(tick: Tick) -> tuple[Any, ...]:
    """Determines the channels of a tick: two ticks with the same signature have the same channels."""
    measurement, estimate, reference, truth = tick.measurement, tick.estimate, tick.reference, tick.truth
    return (
        tuple(measurement.wrenches),
        tuple(estimate.wrenches),
        tuple(estimate.contacts),
        tuple(estimate.environments),
        tuple(estimate.surfaces),
        estimate.disturbance is None,
        tuple([_task_signature(task) for task in reference.tasks]),
        reference.posture is None,
        tuple(reference.diagnostics or ()),  # None, which is none, is refused where channels are made
        tuple(tick.command.diagnostics or ()),
        None
        if truth is None
        else (
            tuple(truth.positions),
            tuple(truth.rotations),
            tuple(truth.wrenches),
            tuple(truth.objects),
            truth.limit_excess is None,
        ),
    )


def _task_signature(task: TaskReference) -> tuple[Any, ...]:
    tuning = task.tuning
    return task.frame, task.rotation is None, tuning is None, tuning is None or tuning.linear_range is None


def groups(tick: Tick, info: RunInfo, units: Sequence[Channel] = ()) -> Groups:
    """The channels of ticks like this one.

    Args:
        tick: an example.
        info: for the names of the joints.
        units: table of units of diagnostics; names may be patterns, the first that fits counts.

    Raises:
        ConfigError: a diagnostic has the name of another channel.
        ShapeError: a diagnostic is neither a number nor an array of numbers.
    """
    joints = joint_labels(info, tick.measurement.q.shape[0])
    signals = [*_fixed(tick, joints), *_wrenches(tick), *_tasks(tick), *_truth(tick, joints)]
    arrays: list[ChannelGroup] = []
    scalars: list[ChannelGroup] = []
    for name in ("command", "reference"):
        more_arrays, more_scalars = _diagnostics(tick, name, (*units, *DIAGNOSTICS))
        arrays += more_arrays
        scalars += more_scalars
    scalars.append(ChannelGroup(lambda tick: (tick.guard,), (Channel("guard/fault", "1"),)))
    if contacts := tuple(tick.estimate.contacts):
        named = tuple(Channel(f"estimate/{frame}/contact", "1") for frame in contacts)
        scalars.append(_mapping("estimate.contacts", contacts, named))
    more_arrays, more_scalars = contact_groups(tick.estimate)
    signals, scalars = signals + more_arrays, scalars + more_scalars
    _check_unique([channel.name for group in (*signals, *arrays, *scalars) for channel in group.channels])
    return Groups(tuple(signals), tuple(arrays), tuple(scalars))


def joint_labels(info: RunInfo, n: int) -> tuple[str, ...]:
    """(n,) names of the joints."""
    return info.joints if len(info.joints) == n else tuple(f"joint_{i + 1}" for i in range(n))


def axis_labels(size: int) -> tuple[str, ...]:
    """Names of the entries of a task-space vector."""
    spatial = ("x", "y", "z", "rx", "ry", "rz")
    return spatial[:size] if size in (3, 6) else tuple(str(i) for i in range(size))


def _fixed(tick: Tick, joints: tuple[str, ...]) -> list[ChannelGroup]:
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
    channels = tuple(Channel(f"{signal}/{field}", unit, (len(joints),), joints) for signal, field, unit in fields)
    return [ChannelGroup(attrgetter(*[f"{signal}.{field}" for signal, field, _ in fields]), channels)]


def _wrenches(tick: Tick) -> list[ChannelGroup]:
    found: list[ChannelGroup] = []
    for signal in ("measurement", "estimate", "truth"):
        part = getattr(tick, signal)
        if part is not None and part.wrenches:
            frames = tuple(part.wrenches)
            named = tuple(Channel(f"{signal}/{frame}/wrench", _WRENCH, (6,), axis_labels(6)) for frame in frames)
            found.append(_mapping(f"{signal}.wrenches", frames, named))
    return found


def _tasks(tick: Tick) -> list[ChannelGroup]:
    found: list[ChannelGroup] = []
    for index, task in enumerate(tick.reference.tasks):
        found.append(_task(index, task))
        if task.rotation is not None:
            found.append(_task_rotation(index, task.frame))
    return found


def _task_rotation(index: int, frame: str) -> ChannelGroup:
    """A group of its own: matrices from pinocchio have the memory layout of Fortran."""
    channel = Channel(f"reference/{frame}/rotation", "1", (3, 3))
    return ChannelGroup(lambda tick: (tick.reference.tasks[index].rotation,), (channel,))


def _task(index: int, task: TaskReference) -> ChannelGroup:
    fields = (("position", "m", 3), ("velocity", _TWIST, 6), ("acceleration", _ACCELERATION, 6), ("wrench", _WRENCH, 6))
    channels = [Channel(f"reference/{task.frame}/{name}", unit, (k,), axis_labels(k)) for name, unit, k in fields]
    names = [name for name, _, _ in fields]
    if task.tuning is not None:
        shape = (task.tuning.axes,)
        given = [name for name in _TUNING_UNITS if getattr(task.tuning, name) is not None]
        names += [f"tuning.{name}" for name in given]
        channels += [
            Channel(f"reference/{task.frame}/{name}", _TUNING_UNITS[name], shape, axis_labels(shape[0]))
            for name in given
        ]
    pick = attrgetter(*names)
    return ChannelGroup(lambda tick: pick(tick.reference.tasks[index]), tuple(channels))


def _truth(tick: Tick, joints: tuple[str, ...]) -> list[ChannelGroup]:
    truth = tick.truth
    if truth is None:
        return []
    fields = [("q", _JOINT), ("v", _JOINT_RATE), ("torque", _TORQUE)]
    if truth.limit_excess is not None:
        fields.append(("limit_excess", _JOINT))
    channels = tuple(Channel(f"truth/{name}", unit, (len(joints),), joints) for name, unit in fields)
    found = [ChannelGroup(attrgetter(*[f"truth.{name}" for name, _ in fields]), channels)]
    for field, name, unit, shape in (
        ("positions", "{}/position", "m", (3,)),
        ("rotations", "{}/rotation", "1", (3, 3)),
        ("objects", "objects/{}/pose", "m, 1", (7,)),
    ):
        keys = tuple(getattr(truth, field))
        if keys:
            named = tuple(Channel(f"truth/{name.format(key)}", unit, shape, _labels(shape)) for key in keys)
            found.append(_mapping(f"truth.{field}", keys, named))
    return found


def _labels(shape: tuple[int, ...]) -> tuple[str, ...]:
    return ("x", "y", "z", "qw", "qx", "qy", "qz") if shape == (7,) else axis_labels(math.prod(shape))


def _diagnostics(tick: Tick, signal: str, units: Sequence[Channel]) -> tuple[list[ChannelGroup], list[ChannelGroup]]:
    entries = getattr(tick, signal).diagnostics
    if not isinstance(entries, Mapping) or not all(isinstance(name, str) for name in entries):
        raise ShapeError(f"the {signal}'s diagnostics must be a mapping from names to numbers, got {entries!r:.80}")
    arrays: list[Channel] = []
    scalars: list[Channel] = []
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
        (arrays if sample.ndim else scalars).append(Channel(name, unit, sample.shape, labels))
    return _both(signal, arrays), _both(signal, scalars)


def _registered(name: str, units: Sequence[Channel]) -> tuple[str, tuple[str, ...]]:
    for known in units:
        if fnmatchcase(name, known.name):
            return known.unit, known.labels
    return "", ()


def _both(signal: str, channels: list[Channel]) -> list[ChannelGroup]:
    keys = tuple(channel.name for channel in channels)
    return [_mapping(f"{signal}.diagnostics", keys, tuple(channels))] if keys else []


def _mapping(path: str, keys: tuple[str, ...], channels: tuple[Channel, ...]) -> ChannelGroup:
    find, pick = attrgetter(path), itemgetter(*keys)
    if len(keys) == 1:
        return ChannelGroup(lambda tick: (pick(find(tick)),), channels)
    return ChannelGroup(lambda tick: pick(find(tick)), channels)


def _check_unique(names: list[str]) -> None:
    if len(set(names)) != len(names):
        twice = sorted({name for name in names if names.count(name) > 1})
        raise ConfigError(f"every channel needs a name of its own, used more than once: {', '.join(twice)}")
