"""Trajectories: pure functions of time."""
