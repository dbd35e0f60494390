"""Estimated contact properties as lines of text on the page."""

from __future__ import annotations

import math
import time

import numpy as np
import viser

from pliant.environment import Environment, EstimatedSurface
from pliant.live.link.messages import Picture

_EVERY = 0.3  # s between two updates, because a browser lays out the page again after each


class EstimatesPanel:
    """The lines; hidden where nothing is estimated. Args: server: the page."""

    def __init__(self, server: viser.ViserServer) -> None:
        self._text = server.gui.add_markdown("", visible=False)
        self._due = 0.0

    def show(self, picture: Picture) -> None:
        """Shows the estimates at the instant of a picture."""
        now = time.monotonic()
        if now < self._due:
            return
        self._due = now + _EVERY
        lines = [environment_line(frame, felt) for frame, felt in picture.environments.items()]
        lines += [surface_line(frame, felt) for frame, felt in picture.surfaces.items()]
        self._text.visible = bool(lines)
        text = "<br/>".join(lines)
        if text != self._text.content:
            self._text.content = text


def environment_line(frame: str, felt: Environment) -> str:
    """Estimated stiffness and damping of the contact of a frame, with standard uncertainties."""
    stiffness = _number(felt.stiffness, felt.stiffness_std, "N/m")
    damping = _number(felt.damping, felt.damping_std, "N·s/m")
    return f"estimated at **{frame}**: stiffness {stiffness}, damping {damping}"


def surface_line(frame: str, felt: EstimatedSurface) -> str:
    """Estimated rotation of the surface that a frame touches, away from the believed one."""
    turn, std = math.degrees(float(np.linalg.norm(felt.turn))), math.degrees(felt.normal_std)
    return f"estimated at **{frame}**: surface tilted by {_number(turn, std, '°')}"


def _number(value: float, std: float, unit: str) -> str:
    if not (math.isfinite(value) and math.isfinite(std)):
        return "unknown"
    return f"{float(f'{value:.3g}'):g} ± {float(f'{std:.2g}'):g} {unit}"
