"""Planners: targets that jump become motion."""
