"""Haptic exploration of one axis: a state machine over plain numbers, so that a tick takes about a microsecond."""

from __future__ import annotations

import math

from pliant.references.exploration.rules import AxisLimits, AxisPhase, AxisRules
from tests.twins.exploration.release import Retreat
from tests.twins.exploration.sliding_span import SlidingSpan

_CAUTION = 3.0
"""a contact at rest shows at most K_0; a larger apparent stiffness is oscillation, which reduces the gain by up to this
factor"""


# s after a drop of F_d; a retreat at another time is a response to noise or oscillation and needs no special handling
_RELIEF = 0.25


_HASTE = 2.0
"""share of k_I in a retreat, which regulates the impedance's own spring and must wait for the timeout of its phases"""


class ExploredAxis:
    """State of one axis. `step` changes it in place; the source that owns it passes it on from tick to tick."""

    __slots__ = (
        "absent",
        "at_bound",
        "clamped",
        "filtered",
        "forces",
        "offset",
        "phase",
        "quiet",
        "reachable",
        "relief",
        "retreat",
        "stiffness",
        "target",
        "targets",
        "touching",
        "unreachable",
        "wanted",
    )

    def __init__(self) -> None:
        self.offset = 0.0
        """Δx, m or rad"""
        self.phase = AxisPhase.OFF
        self.stiffness = 0.0
        """K̂, N/m: change of force per motion of the target; 0 until the first step"""
        self.reachable = 0.0
        """largest force that the bound of the offset allows, N"""
        self.unreachable = False
        self.clamped = 0.0
        """part of the desired force that exceeds F_max, N"""
        self.touching = False
        self.filtered = 0.0
        self.quiet = 0.0
        self.absent = 0.0
        self.at_bound = 0.0
        self.target = 0.0
        """last x_d + Δx, m"""
        self.retreat = Retreat()
        self.wanted = 0.0
        """last F_d, clamped, N"""
        self.relief = 0.0
        """s for which a retreat may still be a response to a drop of F_d"""
        self.forces, self.targets = SlidingSpan(), SlidingSpan()

    def step(
        self,
        rules: AxisRules,
        limits: AxisLimits,
        desired: float,
        force: float,
        position: float,
        time: float,
        period: float,
        asked: bool = False,
    ) -> None:
        """Moves the offset.

        Args:
            rules: parameters.
            limits: K_0, F_max, x_b of the axis.
            desired: F_d, N.
            force: F, measured, N.
            position: x_d without the offset, m.
            time: s.
            period: s since the last step.
            asked: whether F_d = 0 is a request: the target then gives way until F is below the threshold of contact.
        """
        if desired == 0.0 and not asked and self.offset == 0.0 and self.phase is AxisPhase.OFF:
            self.target, self.wanted, self.clamped, self.filtered = position, 0.0, 0.0, force
            return
        wanted = min(max(desired, -limits.force_max), limits.force_max)
        self.clamped = desired - wanted
        if abs(wanted) < abs(self.wanted) - rules.contact_on:
            self.relief = _RELIEF
        self.wanted, self.relief = wanted, max(self.relief - period, 0.0)
        active = (wanted != 0.0 or asked) and limits.stiffness > 0.0
        self._feel(rules, force, period)
        self._switch(rules, active, period)
        if self.phase is AxisPhase.CONTACT:
            if self.retreat.began and self.stiffness < 0.5 * limits.stiffness:
                self.retreat.end()  # a soft contact that seemed stiff because of its damping
                self.retreat.waived = True
            lasting = self.retreat.lasting(force)
            if self.retreat.resting > 0.0:
                self.forces.clear()  # the impedance switches, so the force has no information about the contact
                self.targets.clear()
            else:
                self._learn(rules, limits.stiffness, lasting, time, period)
            gain = _HASTE * rules.gain if self.retreat.began else rules.gain
            rate = -gain * (wanted - lasting) / self.stiffness
            eased = self.relief > 0.0 and self.stiffness > 0.5 * limits.stiffness
            rate = min(max(rate, -rules.speed), rules.speed)
            if wanted != 0.0:
                rate = self.retreat.rate(rules, rate, force, wanted, period, eased)
            free = self.offset + rate * period
        else:
            self._forget(limits.stiffness)
            free = self._returning(rules, wanted, period)
        self.offset = min(max(free, -limits.range), limits.range)
        self.target = position + self.offset
        self._diagnose(rules, limits, wanted, force, free, period)

    def hold(self, limits: AxisLimits) -> None:
        """Holds the offset (there is no force signal), within its bound."""
        self.offset = min(max(self.offset, -limits.range), limits.range)

    def _feel(self, rules: AxisRules, force: float, period: float) -> None:
        """Contact with hysteresis: a filtered force begins it, a force that stays low ends it."""
        share = period / (rules.contact_filter + period) if period > 0.0 else 0.0
        self.filtered += share * (force - self.filtered)
        if abs(self.filtered) > rules.contact_on:
            self.touching, self.quiet = True, 0.0
        if abs(force) < rules.contact_off or abs(self.filtered) < rules.contact_off:
            self.quiet += period
            if self.quiet >= rules.release_time:
                self.touching = False
        else:
            self.quiet = 0.0

    def _switch(self, rules: AxisRules, active: bool, period: float) -> None:
        if not active:
            self.phase = AxisPhase.OFF
        elif self.touching:
            self.phase, self.absent = AxisPhase.CONTACT, 0.0
        elif self.phase in (AxisPhase.CONTACT, AxisPhase.LOST):
            self.absent += period
            self.phase = AxisPhase.LOST if self.absent < rules.lost_time else AxisPhase.FREE
        else:
            self.phase = AxisPhase.FREE

    def _learn(self, rules: AxisRules, ceiling: float, force: float, time: float, period: float) -> None:
        """K̂ = span of the force / span of the target within the window; it starts at K_0, the stiffest there can be.

        Spans rather than differences: a contact that bounces, or a noisy force, then seems stiff, which reduces the
            gain. With differences it could seem soft, and the higher gain would keep it bouncing.
        """
        oldest = time - rules.window * (1.0 + 1e-9)
        change, moved = self.forces.add(time, force, oldest), self.targets.add(time, self.target, oldest)
        if self.stiffness <= 0.0:
            self.stiffness = ceiling
        # With little motion the ratio is a lower bound: it may raise the estimate, not lower it.
        seen = min(max(change / max(moved, rules.least_motion), rules.stiffness_floor), _CAUTION * ceiling)
        if moved > rules.least_motion or seen > self.stiffness:
            if seen < self.stiffness:  # its inverse, to which the speed of the regulation is proportional, is filtered
                share = period / (rules.window + period)
                self.stiffness /= 1.0 + share * (self.stiffness / seen - 1.0)
            else:  # the estimate rises faster than it falls
                self.stiffness += period / (0.25 * rules.window + period) * (seen - self.stiffness)
        elif self.stiffness > ceiling:
            self.stiffness += period / (rules.window + period) * (ceiling - self.stiffness)
        self.stiffness = max(self.stiffness, min(rules.stiffness_floor, ceiling))

    def _forget(self, ceiling: float) -> None:
        if self.phase is not AxisPhase.LOST:
            self.stiffness = ceiling
            self.forces.clear()
            self.targets.clear()
            self.retreat.end()

    def _returning(self, rules: AxisRules, wanted: float, period: float) -> float:
        """Offset of an axis that does not regulate."""
        offset = self.offset
        if self.phase is AxisPhase.LOST or (self.phase is AxisPhase.FREE and wanted == 0.0):
            return offset
        if self.phase is AxisPhase.FREE and rules.seek_speed > 0.0:
            return offset - math.copysign(rules.seek_speed * period, wanted)
        if self.phase is AxisPhase.FREE and not rules.reset:
            return offset
        step = rules.reset_speed * period
        return math.copysign(max(abs(offset) - step, 0.0), offset)

    def _diagnose(
        self, rules: AxisRules, limits: AxisLimits, wanted: float, force: float, free: float, period: float
    ) -> None:
        """Largest reachable force, and whether the offset stays at its bound while force is missing."""
        if self.phase is not AxisPhase.CONTACT:
            self.reachable, self.at_bound, self.unreachable = limits.force_max, 0.0, False
            return
        side = math.copysign(1.0, wanted)
        room = limits.range + side * self.offset
        self.reachable = min(limits.force_max, max(side * force + min(self.stiffness, limits.stiffness) * room, 0.0))
        missing = abs(wanted) - side * force
        stuck = side * free <= -limits.range and missing > rules.contact_off
        self.at_bound = self.at_bound + period if stuck else 0.0
        self.unreachable = stuck and self.at_bound >= rules.unreachable_time
