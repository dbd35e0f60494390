"""Haptic exploration: targets move until contact forces are the desired ones."""
