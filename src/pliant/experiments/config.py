"""Which keys of a case `--set` may change."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from pliant.configuration import parse_assignments
from pliant.errors import ConfigError

IDENTITY = ("case", "study", "variant")
"""keys that identify a run: tables and files are named after them"""


def assigned(assignments: Iterable[str]) -> dict[str, Any]:
    """The changes that a user's `--set` makes to a case. Raises ConfigError as `parse_assignments` does, and for a key
    that says which run it is."""
    changes = parse_assignments(assignments)
    for key in IDENTITY:
        if key in changes:
            raise ConfigError(f"--set cannot change {key!r}, which says which run it is; name another study or --case")
    return changes
