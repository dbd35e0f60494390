"""What a contact feels like, as far as an estimator knows."""

from __future__ import annotations

from dataclasses import dataclass

from pliant.spatial import Array


@dataclass(frozen=True, slots=True)
class Environment:
    """How the environment is believed to give way along a contact's normal. Each `…_std` is a standard uncertainty."""

    stiffness: float
    """K, N/m"""
    damping: float
    """B, N·s/m"""
    stiffness_std: float
    """N/m"""
    damping_std: float
    """N·s/m; infinite where the motion does not tell"""


@dataclass(frozen=True, slots=True)
class FeltSurface:
    """How a surface stands, as the path of the contact tells: the believed one, turned about a place and shifted."""

    pivot: Array
    """(3,) m, where the contact frame first touched"""
    turn: Array
    """(3,) rad, rotation vector in world axes that turns the believed surface about the pivot"""
    normal: Array
    """(3,) outward unit normal where the frame touches now"""
    normal_std: float
    """rad, standard uncertainty of the normal in its least certain direction"""
