"""Release of a contact through a fractal impedance, in spite of its switching."""

from __future__ import annotations

import math

from pliant.references.exploration.rules import AxisRules

_REST = 0.008  # s in which the force of a rigid contact follows a jump of the impedance


class Retreat:
    """Behaviour of a fractal impedance while its target retreats from a contact.

    It converges then: its force falls from F_m, at which the retreat began, by twice as much as its spring would, to
    F = 2 F_spring − F_m, and would push away beyond F = 0. When the error grows again it returns to the spring; at rest
    it does so after its own timeout. So the lasting force is (F + F_m)/2; a retreat ends when that is the desired one,
    or before F reaches zero, and it ends with a short step back towards the contact.
    """

    __slots__ = ("began", "left", "resting", "turning", "waived")

    def __init__(self) -> None:
        self.end()

    def end(self) -> None:
        """No retreat in progress."""
        self.waived = False
        """this retreat needs no special handling: it began on a soft contact, which the impedance's switching does not
        disturb"""
        self.began = 0.0
        """F_m, N; 0 without a retreat"""
        self.turning = 0.0
        """s that the step back may still last"""
        self.left = 0.0
        """F when the step back began, N"""
        self.resting = 0.0
        """s for which the target still waits until the impedance has returned to its spring"""

    def lasting(self, force: float) -> float:
        """The force that the spring would give here, N."""
        return 0.5 * (force + self.began) if self.began else force

    def rate(self, rules: AxisRules, rate: float, force: float, wanted: float, period: float, asked: bool) -> float:
        """Motion of the target, m/s, given the one that the regulator asks for."""
        inward = math.copysign(rate, rate * wanted)
        if self.resting > 0.0:
            self.resting -= period
            return 0.0
        if self.turning > 0.0:
            self.turning -= period
            returned = abs(force - self.left) > 0.5 * abs(self.lasting(self.left) - self.left)
            if returned or self.turning <= 0.0:
                self.end()
                self.resting = _REST
                return 0.0
            return -math.copysign(rules.turn_speed, wanted)
        if not self.began:
            if inward > 2.0 * rules.turn_speed:
                if asked and not self.waived and rules.turn_time > 0.0:
                    self.began = force
                self.waived = True
            elif inward < rules.turn_speed:
                self.waived = False
            return rate
        least = max(0.1 * abs(self.began), rules.contact_on)
        if inward < rules.turn_speed or abs(force) < least:
            self.turning, self.left = rules.turn_time, force
            return 0.0
        return rate
