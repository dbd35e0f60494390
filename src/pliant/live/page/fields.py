"""The leaves of a typed configuration: what each is called, means, and may be."""

from __future__ import annotations

import types
import typing
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from enum import Enum
from typing import Any, Literal, get_args, get_origin

from annotated_types import Ge, Gt, Le, Lt
from pydantic import BaseModel
from pydantic.fields import FieldInfo

from pliant.quantity import unit_of

_SLASH, _SPACE = "\u2215", "\u00a0"  # browsers break lines at the plain ones
_TINY = 1e-4  # numbers below it are shown in full, as text
Path = tuple[str, ...]
Kind = Literal["number", "integer", "switch", "choice", "vector", "text"]


@dataclass(frozen=True, slots=True)
class Leaf:
    """One value that can be changed."""

    path: Path
    """keys from the root of the configuration"""
    value: Any
    kind: Kind
    unit: str
    description: str
    minimum: float | None
    maximum: float | None
    """usual range, for the slider; the configuration has the limits"""
    choices: tuple[str, ...] = ()
    optional: bool = False
    """whether the value may be none"""

    @property
    def label(self) -> str:
        """Name and unit, for the control."""
        name = self.path[-1].replace("_", " ")
        parts = [part.replace("/", _SLASH).replace(" ", _SPACE) for part in self.unit.split(", ")]
        unit = ", ".join(parts)  # each unit stays in one line
        return f"{name} [{unit}]" if self.unit and self.unit != "1" else name


@dataclass(frozen=True, slots=True)
class FieldGroup:
    """A configuration inside another one."""

    path: Path
    description: str
    entries: tuple[Leaf | FieldGroup, ...]

    @property
    def label(self) -> str:
        return self.path[-1].replace("_", " ") if self.path else ""

    def leaves(self) -> Iterator[Leaf]:
        """Every value in it and below it."""
        for entry in self.entries:
            if isinstance(entry, Leaf):
                yield entry
            else:
                yield from entry.leaves()


def group_of(
    config: BaseModel, path: Path = (), description: str = "", skip: frozenset[str] = frozenset()
) -> FieldGroup:
    """Reads a configuration.

    Args:
        config: any pydantic model.
        path: where it stands in a larger one.
        description: of the whole.
        skip: fields to leave out at this level.
    """
    entries: list[Leaf | FieldGroup] = []
    for name, about in type(config).model_fields.items():
        if name not in skip:
            entries += _entries(getattr(config, name), about, (*path, name))
    return FieldGroup(path, description, tuple(entries))


def at(config: BaseModel, path: Path) -> Any:
    """The value at a place of a configuration."""
    value: Any = config
    for key in path:
        value = value[key] if isinstance(value, Mapping) else getattr(value, key)
    return value


def nested(path: Path, value: Any) -> dict[str, Any]:
    """`{"a": {"b": value}}` for the path `("a", "b")`."""
    tree: Any = value
    for key in reversed(path):
        tree = {key: tree}
    return tree


def _entries(value: Any, about: FieldInfo, path: Path) -> list[Leaf | FieldGroup]:
    if isinstance(value, BaseModel):
        return [group_of(value, path, about.description or "")]
    if isinstance(value, Mapping) and value and all(isinstance(v, BaseModel) or v is None for v in value.values()):
        inner = [group_of(v, (*path, str(k)), f"{about.description or ''}") for k, v in value.items() if v is not None]
        return list(inner)
    leaf = _leaf(value, about, path)
    return [] if leaf is None else [leaf]


def _leaf(value: Any, about: FieldInfo, path: Path) -> Leaf | None:
    extra = about.json_schema_extra if isinstance(about.json_schema_extra, dict) else {}
    kinds = _unpacked(about.annotation)
    optional = type(None) in kinds
    low, high = _limits(about)
    choices = _choices(kinds)
    kind = _kind(value, kinds, choices)
    if kind is None:
        return None
    return Leaf(
        path=path,
        value=value,
        kind=kind,
        unit=unit_of(about),
        description=about.description or "",
        minimum=_number(extra.get("minimum"), low),
        maximum=_number(extra.get("maximum"), high),
        choices=choices,
        optional=optional,
    )


def _kind(value: Any, kinds: list[Any], choices: tuple[str, ...]) -> Kind | None:
    if choices and (value is None or isinstance(value, (str, Enum)) or value in kinds or str(value) in choices):
        return "choice"
    if isinstance(value, bool):
        return "switch"
    if isinstance(value, float):
        return "text" if 0.0 < abs(value) < _TINY else "number"
    if isinstance(value, int):
        return "number" if float in kinds else "integer"
    if isinstance(value, tuple) and len(value) == 3 and all(isinstance(v, (int, float)) for v in value):
        return "vector"
    if value is None and not {float, int, str} & set(kinds):
        return None  # a whole part that is switched off: for a configuration file
    if isinstance(value, tuple) and any(isinstance(v, BaseModel) for v in value):
        return None  # a list of parts: for a configuration file
    if value is None or isinstance(value, (str, tuple)):
        return "text"
    return None


def _unpacked(annotation: Any) -> list[Any]:
    """The types that an annotation allows, without unions and `Annotated`."""
    if get_origin(annotation) is typing.Annotated:
        return _unpacked(get_args(annotation)[0])
    if get_origin(annotation) in (typing.Union, types.UnionType):
        return [kind for part in get_args(annotation) for kind in _unpacked(part)]
    return [annotation]


def _choices(kinds: list[Any]) -> tuple[str, ...]:
    found: list[str] = []
    for kind in kinds:
        if get_origin(kind) is Literal:
            found += [str(choice) for choice in get_args(kind)]
        elif isinstance(kind, type) and issubclass(kind, Enum):
            found += [str(member.value) for member in kind]
    return tuple(found)


def _limits(about: FieldInfo) -> tuple[float | None, float | None]:
    low: float | None = None
    high: float | None = None
    for rule in about.metadata:
        match rule:
            case Ge(ge=bound) | Gt(gt=bound):
                low = float(typing.cast(float, bound))
            case Le(le=bound) | Lt(lt=bound):
                high = float(typing.cast(float, bound))
            case _:
                pass
    return low, high


def _number(given: Any, otherwise: float | None) -> float | None:
    return float(given) if isinstance(given, (int, float)) else otherwise
