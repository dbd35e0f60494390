"""Estimated properties of a contact."""

from __future__ import annotations

from dataclasses import dataclass

from pliant.spatial import Array


@dataclass(frozen=True, slots=True)
class Environment:
    """Estimated stiffness and damping of the environment along a contact's normal. Each `…_std` is a standard
    uncertainty."""

    stiffness: float
    """K, N/m"""
    damping: float
    """B, N·s/m"""
    stiffness_std: float
    """N/m"""
    damping_std: float
    """N·s/m; infinite where the motion does not determine the damping"""


@dataclass(frozen=True, slots=True)
class EstimatedSurface:
    """Estimated pose of a surface, from the path of the contact: the believed surface, turned about a point and
    shifted."""

    pivot: Array
    """(3,) m, where the contact frame first touched"""
    turn: Array
    """(3,) rad, rotation vector in world axes that turns the believed surface about the pivot"""
    normal: Array
    """(3,) outward unit normal where the frame touches now"""
    normal_std: float
    """rad, standard uncertainty of the normal in its least certain direction"""
