"""Typed face of frozen values made in one call, and of views of one array (cpp/values)."""

from collections.abc import Sequence
from typing import Any, TypeVar

from pliant.spatial import Array

_Value = TypeVar("_Value")

def make_by_slots(kind: type, fields: list[tuple[str, Any, bool]], absent: object) -> None:
    """From now on a call of the class writes each field into its slot. Arguments that do not fit go to `__init__`,
    which must do the same. For a class that lives as long as the program.

    Args:
        kind: frozen, each field a slot; `__post_init__` is called if it has one.
        fields: of each in turn its name, its default or what makes one, and whether that makes one.
        absent: stands for no default.

    Raises:
        ValueError: a field without a slot, or more than 32 of them.
    """

def changed(value: _Value, **fields: Any) -> _Value:
    """`dataclasses.replace` in about a tenth of the time, for a dataclass whose slots are all of its own class. It
    skips `__post_init__`: do not use it for classes that check their fields.

    Raises:
        AttributeError: a field that the value does not have, or a class without slots.
    """

class Views:
    """Parts of the numbers of an array."""

    def __init__(self, places: Sequence[Sequence[int]]) -> None:
        """Args: places: of each, where it begins and its shape. Raises ValueError for a place without a shape."""

    @property
    def size(self) -> int:
        """Numbers that an array must have."""

    def of(self, numbers: Array) -> tuple[Array, ...]:
        """Views of an array (size or more,). Raises ValueError for another array."""

class NamedViews:
    """Parts of the numbers of an array, by name."""

    def __init__(self, names: Sequence[str], places: Sequence[Sequence[int]]) -> None:
        """Args: names: one for each place. places: as of `Views`. Raises ValueError as there."""

    def of(self, numbers: Array) -> dict[str, Array]:
        """Name → view. Raises ValueError for an array that does not have every place."""

    def into(self, numbers: Array, named: dict[str, Any]) -> None:
        """The same, added to what is already named. Raises ValueError as `of`."""
