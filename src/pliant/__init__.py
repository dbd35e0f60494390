"""pliant: contact control for torque-controlled robots."""

__version__ = "0.1.0"
