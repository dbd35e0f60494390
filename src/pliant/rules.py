"""Why a value is what it is: the rule behind a suggestion, and where the rule comes from."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from fnmatch import fnmatchcase
from typing import Any


@dataclass(frozen=True)
class Rule:
    """How some values of a configuration follow from what is known of robot and task."""

    keys: str
    """dotted keys of these values; `*` stands for any characters"""
    says: str
    """how they follow, in a few words"""
    source: str
    """where that comes from: a bound with its reason, a measurement, a command"""

    def under(self, key: str) -> Rule:
        """The same where the configuration is a part of another. Args: key: of that part."""
        return replace(self, keys=f"{key}.{self.keys}")

    @property
    def of_many(self) -> bool:
        """Whether it tells of a whole table."""
        return self.keys.endswith("*")

    @property
    def told(self) -> str:
        """In one line."""
        return f"{self.says} ({self.source})"


def rule_of(rules: Iterable[Rule], key: str) -> Rule | None:
    """The first rule of a key; None if there is none."""
    return next((rule for rule in rules if fnmatchcase(key, rule.keys)), None)


@dataclass(frozen=True)
class Suggestion:
    """A value that follows from the rest of a configuration where that says nothing."""

    value: Any
    unit: str
    rule: Rule | None
