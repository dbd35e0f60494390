"""What is imperfect about a robot: sensors, drives, gears, computation time."""
