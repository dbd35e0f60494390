"""Every field of every configuration says what it is; every number in which unit, and between which bounds."""

from __future__ import annotations

import ast
import importlib
import inspect
import pkgutil
from collections.abc import Iterator
from pathlib import Path
from types import UnionType
from typing import Any, get_args, get_origin

import pytest
from pydantic import Field, ValidationError

import pliant
from pliant.configuration import Config
from pliant.quantity import quantity, unit_of

NOT_IMPORTED = ("_render_child", "templates", "__main__")
BOUNDS = ("ge", "gt", "le", "lt")


def configurations() -> list[type[Config]]:
    """Every class of the package, whether anybody lists it or not."""
    for module in pkgutil.walk_packages(pliant.__path__, "pliant."):
        if not any(part in module.name for part in NOT_IMPORTED):
            importlib.import_module(module.name)

    def below(kind: type[Config]) -> Iterator[type[Config]]:
        for one in kind.__subclasses__():
            if one.__module__.startswith("pliant."):
                yield one
            yield from below(one)

    return sorted(set(below(Config)), key=lambda kind: f"{kind.__module__}.{kind.__qualname__}")


def faults(kind: type[Config]) -> list[str]:
    """What its own fields, or those whose default it changes, do not say."""
    found: list[str] = []
    for name, about in kind.model_fields.items():
        if name not in vars(kind).get("__annotations__", {}):
            continue
        union = get_origin(about.annotation) is UnionType
        kinds: tuple[Any, ...] = get_args(about.annotation) if union else (about.annotation,)
        if not about.description and not any(inspect.isclass(one) and issubclass(one, Config) for one in kinds):
            found.append(f"{name}: no description")
        extra = about.json_schema_extra
        if float in kinds and not (isinstance(extra, dict) and extra.get("unit")):
            found.append(f"{name}: no unit")
        number = {float, int} & set(kinds) and set(kinds) <= {float, int, type(None)}
        if number and not any(getattr(one, bound, None) is not None for one in about.metadata for bound in BOUNDS):
            found.append(f"{name}: no bound")
    return found


CONFIGURATIONS = configurations()


@pytest.mark.parametrize("kind", CONFIGURATIONS, ids=lambda kind: kind.__qualname__)
def test_every_field_says_what_it_is(kind: type[Config]) -> None:
    assert faults(kind) == []


def written_by_hand(source: str) -> list[int]:
    """Lines that give a field's unit in a dictionary of their own instead of calling `quantity`."""
    return [
        node.value.lineno
        for node in ast.walk(ast.parse(source))
        if isinstance(node, ast.keyword) and node.arg == "json_schema_extra"
    ]


def test_a_unit_is_given_in_one_way() -> None:
    package = Path(str(pliant.__file__)).parent
    found = {
        path.relative_to(package).as_posix() for path in package.rglob("*.py") if written_by_hand(path.read_text())
    }
    assert found == {"quantity.py"}
    assert written_by_hand('a = Field(1.0, json_schema_extra={"unit": "m"})') == [1]  # it would be noticed


def test_a_quantity_keeps_its_limits_and_not_those_of_its_slider() -> None:
    class Spring(Config):
        stiffness: float = quantity(10.0, "N/m", "K", shown=(1.0, 20.0), ge=0.0)

    field = Spring.model_fields["stiffness"]
    assert (field.default, unit_of(field), field.description) == (10.0, "N/m", "K")
    assert field.json_schema_extra == {"unit": "N/m", "minimum": 1.0, "maximum": 20.0}
    assert Spring(stiffness=21.0).stiffness == 21.0
    with pytest.raises(ValidationError):
        Spring(stiffness=-1.0)


def test_all_are_found_and_what_says_nothing_is_noticed() -> None:
    assert len(CONFIGURATIONS) > 70

    class Silent(Config):
        length: float = 1.0
        count: int = Field(default=1, description="of things")
        share: float = Field(default=0.5, ge=0.0, description="of all")

    assert faults(Silent) == [
        "length: no description",
        "length: no unit",
        "length: no bound",
        "count: no bound",
        "share: no unit",
    ]
