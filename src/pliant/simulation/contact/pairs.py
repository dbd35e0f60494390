"""Contact pairs of a scene, and their contact properties."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import combinations

from pliant.simulation.part import Part
from pliant.simulation.scene import Ball, Box, Plane, Scene, Thing
from pliant.simulation.surface import Surface

PairOfGeoms = tuple[str, str, Surface]
"""two geoms, the second the one that the contact's normal belongs to"""


def pairs_of(scene: Scene, robot_geoms: Iterable[str]) -> list[PairOfGeoms]:
    """All contact pairs.

    The robot is rigid, so the surface of a thing determines its contact with the robot. Between two things it is the
    surface of the movable one, or of the softer one if both can move.

    Args:
        scene: the things.
        robot_geoms: geoms of the robot that touch things.
    """
    pairs: list[PairOfGeoms] = [(geom, thing.name, thing.surface) for geom in robot_geoms for thing in scene.things]
    for first, second in combinations(scene.things, 2):
        if not (can_move(first) or can_move(second)):
            continue
        a, b = sorted((first, second), key=_rank)
        pairs.append((a.name, b.name, _surface(a, b)))
        if isinstance(a, Box) and isinstance(b, Box) and scene.contact == "explicit":
            pairs.append((b.name, a.name, _surface(a, b)))  # boxes meet through their corners, those of both
    return pairs


def _rank(thing: Thing) -> int:
    """Order in which the explicit law takes a pair: balls press on boxes, and everything on planes and parts."""
    return 0 if isinstance(thing, Ball) else 1 if isinstance(thing, Box) else 2


def can_move(thing: Thing) -> bool:
    return not isinstance(thing, Plane | Part) and thing.mass > 0.0


def _surface(a: Thing, b: Thing) -> Surface:
    if can_move(a) and can_move(b):
        return min(a.surface, b.surface, key=lambda surface: surface.stiffness)
    return a.surface if can_move(a) else b.surface
