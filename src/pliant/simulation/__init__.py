"""The simulated robot and its world. Controllers never import this."""

from pliant.simulation.disturbances import Push, random_pushes
from pliant.simulation.force_sensor import ForceSensor
from pliant.simulation.imperfections.config import Imperfections
from pliant.simulation.imperfections.plant import ImperfectPlant, ImperfectWorld
from pliant.simulation.joint_effects import JointEffects
from pliant.simulation.link_capsule import LinkCapsule
from pliant.simulation.plant import MujocoPlant, World
from pliant.simulation.scene import Ball, Box, Plane, Scene, Surface, floor, table, wall

__all__ = [
    "Ball",
    "Box",
    "ForceSensor",
    "ImperfectPlant",
    "ImperfectWorld",
    "Imperfections",
    "JointEffects",
    "LinkCapsule",
    "MujocoPlant",
    "Plane",
    "Push",
    "Scene",
    "Surface",
    "World",
    "floor",
    "random_pushes",
    "table",
    "wall",
]
