"""The things around the leg."""

from __future__ import annotations

import numpy as np

from pliant.simulation import Ball, Box, Plane, Scene, Surface
from pliant.simulation.scene import Thing
from pliant.spatial import rpy
from pliant.studies.haptic.scene_config import Floor, HapticScene, Material

FOOT_RADIUS = 0.02  # m, of the catalogue's leg
FLOOR, BOX, BALL = "floor", "box", "ball"


def scene_of(environment: HapticScene) -> Scene:
    """The scene, ruled by the explicit contact law."""
    things: list[Thing] = []
    if environment.floor is not None:
        things.append(_plane(environment.floor))
    if environment.box is not None:
        box = environment.box
        things.append(Box(BOX, box.size, box.position, box.mass, surface=_surface(box.material)))
    if environment.ball is not None:
        ball = environment.ball
        things.append(Ball(BALL, ball.radius, ball.position, ball.mass, _surface(ball.material)))
    return Scene(tuple(things), contact="explicit")


def _plane(floor: Floor) -> Plane:
    normal = rpy(floor.tilt[0], floor.tilt[1], 0.0)[:, 2]
    n = (float(normal[0]), float(normal[1]), float(normal[2]))
    look = (0.86, 0.87, 0.88, 1.0)
    return Plane(FLOOR, (0.0, 0.0, floor.height), n, _surface(floor.material), (0.6, 0.6), look)


def _surface(material: Material) -> Surface:
    return Surface(material.stiffness, material.damping, material.friction, material.friction_moving)


def touching_height(floor: Floor, x: float, y: float, radius: float) -> float:
    """z of the centre of a sphere that touches the floor above or below (x, y), m."""
    n = rpy(floor.tilt[0], floor.tilt[1], 0.0)[:, 2]
    return float(floor.height + (radius - np.dot(n[:2], (x, y))) / n[2])
