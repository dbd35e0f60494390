"""Haptic exploration of one frame in Python: its axes, or the one direction along the contact normal."""

from __future__ import annotations

import math
from dataclasses import replace

from pliant.axis_modes import AxisModes
from pliant.references.exploration.config import ExplorationConfig
from pliant.references.exploration.frame import FrameRules, in_world
from pliant.references.exploration.rules import AxisLimits, AxisPhase, AxisRules
from pliant.signals import ImpedanceTuning
from pliant.spatial import Array
from tests.twins.exploration.axis import ExploredAxis
from tests.twins.exploration.contact_normal import Vector, turned_normal, within_cone
from tests.twins.exploration.paper import printed_step


class FrameTwin:
    """State of one frame. `step` changes it in place."""

    __slots__ = ("along", "axes", "limits", "linear", "modes", "normal", "offsets", "rotation", "tuning")

    def __init__(self) -> None:
        self.axes = [ExploredAxis() for _ in range(6)]
        self.along = ExploredAxis()
        """the direction of the normal, if there is one"""
        self.normal: Vector | None = None
        self.offsets = [0.0] * 6
        """Δx of every axis, m and rad"""
        self.tuning: ImpedanceTuning | None = None
        self.limits: list[AxisLimits] = []
        self.modes: AxisModes | None = None
        self.rotation: Array | None = None
        """R_world_axes (3, 3) of the offsets; None: world axes"""
        self.linear: tuple[AxisRules, AxisRules] | None = None
        """rules of the translations: as configured, and within the bounds of the modes"""

    def step(
        self,
        rules: FrameRules,
        tuning: ImpedanceTuning,
        desired: list[float],
        measured: list[float] | None,
        position: list[float],
        velocity: list[float],
        time: float,
        period: float,
        modes: AxisModes | None = None,
        rotation: Array | None = None,
    ) -> None:
        """Moves the offsets.

        Args:
            rules: parameters.
            tuning: impedance of the frame, 3 or 6 axes.
            desired: F_d (6,), N and N·m.
            measured: F (6,); None if there is no usable signal: offsets are held.
            position: x_d (3,) without the offset, m.
            velocity: of x_d (3,), m/s.
            time: s.
            period: s since the last tick.
            modes: of the axes; None: a force where F_d is not zero.
            rotation: R_world_axes (3, 3), of the axes in which the other arguments are given; None: world axes. Axes
                that rotate from tick to tick, as those of a path on a curved surface do, carry the offsets with them.
        """
        if modes is not self.modes or (rotation is None) is not (self.rotation is None):
            self._turn_axes(modes, rotation)
        self.rotation = rotation
        if tuning is not self.tuning:
            self._take(tuning)
        if measured is None:
            for axis, limits in zip(self.axes, self.limits, strict=False):
                axis.hold(limits)
            self._bound()
            return
        first = 0
        if rules.config.direction == "normal" and rules.config.mode == "adaptive":
            self._step_normal(rules, desired, measured, position, velocity, time, period)
            first = 3
        linear = self._linear(rules)
        for index in range(first, len(self.limits)):
            axis, limits = self.axes[index], self.limits[index]
            kind = linear if index < 3 else rules.angular
            if rules.config.mode == "paper":
                _step_printed(axis, limits, desired[index], measured[index], rules.config)
            else:
                x = position[index] if index < 3 else 0.0
                asked = modes is not None and modes.modes[index] == "force"
                axis.step(kind, limits, desired[index], measured[index], x, time, period, asked)
            self.offsets[index] = axis.offset

    def _take(self, tuning: ImpedanceTuning) -> None:
        """New impedance: the offsets keep to its bound from this tick on."""
        self.tuning = tuning
        values = zip(tuning.stiffness.tolist(), tuning.force_max.tolist(), tuning.range.tolist(), strict=True)
        self.limits = [AxisLimits(k, f, b if k > 0.0 else 0.0) for k, f, b in values]
        if self.modes is not None:
            far = self.modes.deviation
            linear = [limit._replace(range=min(limit.range, far)) for limit in self.limits[:3]]
            self.limits = [
                AxisLimits(0.0, 0.0, 0.0) if mode == "free" else limit
                for mode, limit in zip(self.modes.modes, linear + self.limits[3:], strict=False)
            ]
        self.axes[len(self.limits) :] = [ExploredAxis() for _ in range(6 - len(self.limits))]
        self._bound()

    def _turn_axes(self, modes: AxisModes | None, rotation: Array | None) -> None:
        """Other modes, perhaps of other axes: the offset stays where it is in the world, its axes begin anew."""
        self.modes, self.tuning, self.linear = modes, None, None
        if self.rotation is None and rotation is None:
            return
        world = in_world(self.rotation, self.offsets)
        self.offsets = world if rotation is None else in_world(rotation.T, world)
        self.axes = [ExploredAxis() for _ in range(6)]
        for axis, offset in zip(self.axes, self.offsets, strict=True):
            axis.offset = offset

    def _linear(self, rules: FrameRules) -> AxisRules:
        """Rules of the translations within the bounds of the modes."""
        if self.modes is None or math.isinf(self.modes.speed):
            return rules.linear
        if self.linear is None or self.linear[0] is not rules.linear:
            given, most = rules.linear, self.modes.speed
            speeds = {name: min(getattr(given, name), most) for name in ("speed", "reset_speed", "seek_speed")}
            self.linear = given, replace(given, **speeds)
        return self.linear[1]

    def _bound(self) -> None:
        for index, limits in enumerate(self.limits):
            self.offsets[index] = min(max(self.offsets[index], -limits.range), limits.range)
        for index in range(len(self.limits), 6):
            self.offsets[index] = 0.0

    def _step_normal(
        self,
        rules: FrameRules,
        desired: list[float],
        measured: list[float],
        position: list[float],
        velocity: list[float],
        time: float,
        period: float,
    ) -> None:
        """One direction instead of three: |F_d| along the normal; the tangential axes follow the impedance."""
        size = math.hypot(*desired[:3])
        if size > 0.0:
            self._turn(rules.config, desired, measured, velocity, size, period)
        normal = self.normal
        if normal is None:
            return
        n_0, n_1, n_2 = normal
        force = n_0 * measured[0] + n_1 * measured[1] + n_2 * measured[2]
        place = n_0 * position[0] + n_1 * position[1] + n_2 * position[2]
        limits = _limits_along(self.limits, normal)
        self.along.step(rules.linear, limits, size, force, place, time, period)
        # Slewed: neither a turning normal nor a change of mode makes the target jump.
        most = 2.0 * max(rules.linear.speed, rules.linear.reset_speed) * period
        for index, n in enumerate(normal):
            change = self.along.offset * n - self.offsets[index]
            self.offsets[index] += min(max(change, -most), most)
        self._bound()
        for axis, offset in zip(self.axes[:3], self.offsets[:3], strict=True):
            axis.offset = offset
            axis.phase, axis.stiffness, axis.clamped = self.along.phase, self.along.stiffness, self.along.clamped
            axis.reachable, axis.unreachable = self.along.reachable, self.along.unreachable

    def _turn(
        self,
        config: ExplorationConfig,
        desired: list[float],
        measured: list[float],
        velocity: list[float],
        size: float,
        period: float,
    ) -> None:
        wanted = (desired[0] / size, desired[1] / size, desired[2] / size)
        normal = self.normal or wanted
        if self.along.phase is AxisPhase.CONTACT:
            force = (measured[0], measured[1], measured[2])
            path = (velocity[0], velocity[1], velocity[2])
            normal = turned_normal(
                normal, force, path, config.contact_on, period, config.normal_time, config.normal_rate
            )
        elif self.along.phase is AxisPhase.FREE and self.along.offset == 0.0:
            normal = wanted  # no contact, and nothing would jump
        self.normal = within_cone(normal, wanted, config.normal_cone)


def _limits_along(limits: list[AxisLimits], normal: Vector) -> AxisLimits:
    """Impedance along a direction: the bound and the force at which the first axis meets its own."""
    stiffness = sum(limit.stiffness * n * n for limit, n in zip(limits, normal, strict=False))
    parts = [(limit, abs(n)) for limit, n in zip(limits, normal, strict=False) if abs(n) > 1e-9]
    return AxisLimits(
        stiffness,
        min(limit.force_max / n for limit, n in parts),
        min(limit.range / n for limit, n in parts),
    )


def _step_printed(
    axis: ExploredAxis, limits: AxisLimits, desired: float, force: float, config: ExplorationConfig
) -> None:
    axis.offset = printed_step(
        desired, force, axis.offset, limits.stiffness, limits.range, config.resolution, config.reset
    )
    touching = abs(force) > config.resolution
    axis.phase = AxisPhase.OFF if desired == 0.0 else AxisPhase.CONTACT if touching else AxisPhase.FREE
    axis.stiffness, axis.reachable = limits.stiffness, limits.force_max
