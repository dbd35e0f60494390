"""Haptic exploration: targets move until the contact forces reach the desired values."""
