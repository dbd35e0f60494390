"""Imperfections of a robot: sensors, drives, gears, computation time."""
