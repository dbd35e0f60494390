"""A log of ten samples, made of arrays that a test writes down."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from pliant.signals import Command, Estimate, ImpedanceTuning, Measurement, Reference, TaskReference, Tick, Truth
from pliant.spatial import Array
from pliant.telemetry import Log, Recorder
from pliant.telemetry.schema import Channel

K = np.arange(10.0)
"""(10,) number of each sample"""


def columns(*values: Any) -> Array:
    """(10, k): one column per value, each a number or (10,)."""
    return np.stack([np.broadcast_to(np.asarray(value, dtype=np.float64), 10) for value in values], axis=1)


def ten_samples(
    period: float,
    joints: int,
    true: Mapping[str, Array],
    wanted: Mapping[str, Array],
    *,
    torque: Array | None = None,
    acting: Array | None = None,
    v: Array | None = None,
    q: Array | None = None,
    felt: Mapping[str, Array] | None = None,
    believed: Mapping[str, Array] | None = None,
    asked: Mapping[str, Array] | None = None,
    tuning: Mapping[str, ImpedanceTuning] | None = None,
    objects: Mapping[str, Array] | None = None,
    command: Mapping[str, Array] | None = None,
    reference: Mapping[str, Array] | None = None,
    channels: Sequence[Channel] = (),
    phases: Sequence[str] = ("",) * 10,
) -> Log:
    """What a run of ten ticks would have left.

    Args:
        period: s.
        joints: n.
        true, wanted: frame → (10, 3) m.
        torque, acting: (10, n) N·m, sent, and truly there.
        v, q: (10, n) true.
        felt, believed, asked: frame → (10, 6) true, estimated and desired wrench, N and N·m.
        tuning: frame → what references carry.
        objects: name → (10, 7).
        command, reference: name → (10, …) diagnostics.
        channels: of the diagnostics that are not known by their names.
        phases: of the reference.
    """
    none = np.zeros((10, joints))
    sent, there, rates, angles = (none if given is None else given for given in (torque, acting, v, q))
    recorder = Recorder(None, channels=channels)
    with recorder:
        for k in range(10):
            time, zero = period * k, np.zeros(joints)

            def at(values: Mapping[str, Array] | None, k: int = k) -> dict[str, Any]:
                return {name: samples[k] for name, samples in (values or {}).items()}

            wrenches = at(asked)
            tasks = tuple(
                TaskReference(frame, place, wrench=wrenches.get(frame, np.zeros(6)), tuning=(tuning or {}).get(frame))
                for frame, place in at(wanted).items()
            )
            recorder(
                Tick(
                    Measurement(time, angles[k], rates[k], zero, sent[k]),
                    Estimate(time, angles[k], rates[k], zero, zero, at(believed)),
                    Reference(time, tasks, phase=phases[k], diagnostics=at(reference)),
                    Command(time, sent[k], zero, at(command)),
                    Truth(time, angles[k], rates[k], there[k], at(true), {}, at(felt), at(objects)),
                )
            )
    return recorder.log()
