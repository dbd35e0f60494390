"""Haptic exploration of one frame: its axes, or the one direction along the contact normal. The handle of
`cpp/references/exploration`."""

from __future__ import annotations

import math
from dataclasses import replace

from pliant._references import FrameCore
from pliant.axis_modes import AxisModes
from pliant.references.exploration.config import ExplorationConfig
from pliant.references.exploration.rules import AxisLimits, AxisRules
from pliant.signals import ImpedanceTuning
from pliant.spatial import Array


class FrameRules:
    """A configuration prepared for use in every tick."""

    __slots__ = ("angular", "axes", "config", "linear", "normal")

    def __init__(self, config: ExplorationConfig) -> None:
        self.config = config
        self.linear = AxisRules.of(config, rotation=False)
        self.angular = AxisRules.of(config, rotation=True)
        self.axes = config.direction == "axes"
        self.normal = (config.contact_on, config.normal_time, config.normal_rate, config.normal_cone)


class ExploredFrame:
    """State of one frame, of which `core` moves the offsets. Changed in place."""

    __slots__ = ("core", "count", "modes", "rotation", "rules", "tuning")

    def __init__(self) -> None:
        self.core = FrameCore()
        self.count = 0
        """axes of the impedance, 3 or 6"""
        self.tuning: ImpedanceTuning | None = None
        self.rules: FrameRules | None = None
        self.modes: AxisModes | None = None
        self.rotation: Array | None = None
        """R_world_axes (3, 3) of the offsets; None: world axes"""

    def prepare(
        self, rules: FrameRules, tuning: ImpedanceTuning, modes: AxisModes | None = None, rotation: Array | None = None
    ) -> None:
        """What holds from this tick on; to be called where one of these is another object than before.

        Args:
            rules: parameters.
            tuning: impedance of the frame, 3 or 6 axes.
            modes: of the axes; None: a force where F_d is not zero.
            rotation: R_world_axes (3, 3), of the axes in which the core is told its vectors; None: world axes. Axes
                that rotate from tick to tick, as those of a path on a curved surface do, carry the offsets with them.
        """
        if modes is not self.modes or (rotation is None) is not (self.rotation is None):
            self._turn_axes(modes, rotation)
        self.rotation = rotation
        if tuning is not self.tuning:
            self._take(tuning)
        if rules is not self.rules:
            self._rule(rules)

    @property
    def offsets(self) -> list[float]:
        """Δx (6,) in the world's axes, m and rad."""
        return in_world(self.rotation, self.core.offsets)

    @property
    def clamped(self) -> list[float]:
        """(6,) parts of the desired force that exceed F_max, in the world's axes, N and N·m."""
        return in_world(self.rotation, self.core.clamped)

    def _take(self, tuning: ImpedanceTuning) -> None:
        """New impedance: the offsets keep to its bound from this tick on."""
        self.tuning = tuning
        values = zip(tuning.stiffness.tolist(), tuning.force_max.tolist(), tuning.range.tolist(), strict=True)
        limits = [AxisLimits(k, f, b if k > 0.0 else 0.0) for k, f, b in values]
        if self.modes is not None:
            far = self.modes.deviation
            linear = [limit._replace(range=min(limit.range, far)) for limit in limits[:3]]
            limits = [
                AxisLimits(0.0, 0.0, 0.0) if mode == "free" else limit
                for mode, limit in zip(self.modes.modes, linear + limits[3:], strict=False)
            ]
        self.count = len(limits)
        self.core.limit(limits)

    def _turn_axes(self, modes: AxisModes | None, rotation: Array | None) -> None:
        """Other modes, perhaps of other axes: the offset stays where it is in the world, its axes begin anew."""
        self.modes, self.tuning, self.rules = modes, None, None
        if self.rotation is None and rotation is None:
            return
        world = self.offsets
        self.core.begin(world if rotation is None else in_world(rotation.T, world))

    def _rule(self, rules: FrameRules) -> None:
        """Other parameters. Those of the translations keep to the bounds of the modes."""
        self.rules, config, linear, modes = rules, rules.config, rules.linear, self.modes
        if modes is not None and not math.isinf(modes.speed):
            speeds = {name: min(getattr(linear, name), modes.speed) for name in ("speed", "reset_speed", "seek_speed")}
            linear = replace(linear, **speeds)
        asked = (False,) * 6 if modes is None else modes.having("force")
        printed = config.mode == "paper"
        self.core.rule(
            linear.numbers, rules.angular.numbers, asked, printed, not rules.axes, config.resolution, rules.normal
        )


def in_world(rotation: Array | None, offsets: list[float]) -> list[float]:
    """(6,) of axes (3, 3) R_world_axes in the world's. Args: rotation: None: they are the world's."""
    if rotation is None:
        return offsets
    return [*(rotation @ offsets[:3]).tolist(), *(rotation @ offsets[3:]).tolist()]
