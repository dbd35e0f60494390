"""Typed configurations, as `pliant.configuration` has them."""

from pliant.configuration import Config, merged, parse_assignments, read_toml, validated

__all__ = ["Config", "merged", "parse_assignments", "read_toml", "validated"]
