"""The simulated robot and its world. Controllers never import this."""

from pliant.simulation.disturbances import Push
from pliant.simulation.force_sensor import ForceSensor
from pliant.simulation.imperfections.config import Imperfections
from pliant.simulation.imperfections.plant import ImperfectPlant, ImperfectWorld
from pliant.simulation.joint_effects import JointEffects
from pliant.simulation.joint_stops import JointStops
from pliant.simulation.link_capsule import LinkCapsule
from pliant.simulation.part import Part
from pliant.simulation.plant import MujocoPlant
from pliant.simulation.scene import Ball, Box, Plane, Scene, fixed_part, floor, table, wall
from pliant.simulation.surface import Surface
from pliant.simulation.surface_change import SurfaceChange
from pliant.simulation.world import World

__all__ = [
    "Ball",
    "Box",
    "ForceSensor",
    "ImperfectPlant",
    "ImperfectWorld",
    "Imperfections",
    "JointEffects",
    "JointStops",
    "LinkCapsule",
    "MujocoPlant",
    "Part",
    "Plane",
    "Push",
    "Scene",
    "Surface",
    "SurfaceChange",
    "World",
    "fixed_part",
    "floor",
    "table",
    "wall",
]
