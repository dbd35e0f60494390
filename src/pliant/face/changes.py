"""What a call changes of a case."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pliant.dotted import nested
from pliant.errors import ConfigError
from pliant.experiments.config import IDENTITY


def checked_changes(given: Mapping[str, Any]) -> dict[str, Any]:
    """Changes under dotted keys, nested.

    Raises:
        ConfigError: a key that says which run it is.
    """
    changes = nested(given)
    for key in IDENTITY:
        if key in changes:
            raise ConfigError(f"{key!r} says which run it is and cannot be changed")
    return changes
