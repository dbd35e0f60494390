"""The stubs of the compiled cores say what the modules are: names both ways, parameters, defaults, kinds of values.

A compiled function knows its own signature (`__nb_signature__`); the stub is read as source.
"""

from __future__ import annotations

import ast
import re
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

import pliant
from pliant import _contact, _estimation, _guard, _impedance, _loop, _mpc, _plant, _references, _telemetry, _values

CORES = [_contact, _estimation, _guard, _impedance, _loop, _mpc, _plant, _references, _telemetry, _values]
SCALARS = ("int", "float", "bool", "str", "None")


def read_stub(text: str) -> dict[str, str]:
    """Dotted name → what it is: "value", "property -> KIND" or "(parameter: KIND = default, …) -> KIND"."""
    found: dict[str, str] = {}
    tree = ast.parse(text)
    names = {
        node.target.id: ast.unparse(node.value)
        for node in tree.body
        if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name) and node.value is not None
    }
    for node in tree.body:
        if isinstance(node, ast.ClassDef):
            found[node.name] = "class"
            for part in node.body:
                found |= _of_stub(part, f"{node.name}.", names)
        else:
            found |= _of_stub(node, "", names)
    return found


def _of_stub(node: ast.stmt, within: str, names: dict[str, str]) -> dict[str, str]:
    if isinstance(node, ast.FunctionDef):
        if any(ast.unparse(mark).endswith(".setter") for mark in node.decorator_list):
            return {f"{within}{node.name}": f"property -> {_kind(node.args.args[1].annotation, names)}, set"}
        if any(ast.unparse(mark) == "property" for mark in node.decorator_list):
            return {f"{within}{node.name}": f"property -> {_kind(node.returns, names)}"}
        return {f"{within}{node.name}": _signature(node, None, names)}
    if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name) and node.value is None:
        return {f"{within}{node.target.id}": f"property -> {_kind(node.annotation, names)}, set" if within else "value"}
    return {}


def read_module(module: ModuleType) -> dict[str, str]:
    """The same of a compiled module."""
    found: dict[str, str] = {}
    for name, value in vars(module).items():
        if name.startswith("__"):
            continue
        if not isinstance(value, type):
            found[name] = _of_module(value)
            continue
        found[name] = "class"
        for part, inner in vars(value).items():
            if (part == "__init__" and hasattr(inner, "__nb_signature__")) or not part.startswith("_"):
                found[f"{name}.{part}"] = _of_module(inner)
    return found


def _of_module(value: Any) -> str:
    if isinstance(value, property):
        text = value.fget.__nb_signature__[0][0].replace("def (self)", "def get(self)")
        kind = _kind(_parsed(text).returns, {})
        return f"property -> {kind}" + ("" if value.fset is None else ", set")
    if not hasattr(value, "__nb_signature__"):
        return "value"
    assert len(value.__nb_signature__) == 1, "an overloaded function; the comparison knows none"
    text, _, defaults = value.__nb_signature__[0]
    return _signature(_parsed(text), defaults, {})


def _parsed(signature: str) -> ast.FunctionDef:
    marked = re.sub(r"= \\(\d+)", r"= __default[\1]", re.sub(r"ndarray\[[^\]]*\]", "ndarray", signature))
    function = ast.parse(f"{marked}: ...").body[0]
    assert isinstance(function, ast.FunctionDef)
    return function


def _signature(function: ast.FunctionDef, defaults: Any, names: dict[str, str]) -> str:
    arguments = function.args
    plain = [*arguments.posonlyargs, *arguments.args]
    given = [None] * (len(plain) - len(arguments.defaults)) + list(arguments.defaults)
    parts = [_parameter(a, d, defaults, names) for a, d in zip(plain, given, strict=True)]
    if arguments.kwonlyargs:
        parts.append("*")
        parts += [
            _parameter(a, d, defaults, names) for a, d in zip(arguments.kwonlyargs, arguments.kw_defaults, strict=True)
        ]
    return f"({', '.join(parts)}) -> {_kind(function.returns, names)}"


def _parameter(about: ast.arg, default: ast.expr | None, defaults: Any, names: dict[str, str]) -> str:
    if about.arg == "self":
        return "self"
    text = f"{about.arg}: {_kind(about.annotation, names)}"
    if default is None:
        return text
    if isinstance(default, ast.Subscript):  # __default[i]
        return f"{text} = {defaults[ast.literal_eval(default.slice)]!r}"
    return f"{text} = {ast.literal_eval(default)!r}"


def _kind(annotation: ast.expr | None, names: dict[str, str]) -> str:
    """A scalar's type by name, "list", "class NAME", else "object"; what may be None is always an object."""
    if annotation is None:
        return "?"
    text = ast.unparse(annotation)
    text = names.get(text, text)
    if text in SCALARS:
        return text
    if text.startswith("Literal["):
        return "str"
    if text.startswith("float | None"):
        return text
    if re.fullmatch(r"(pliant\._\w+\.)?[A-Z]\w+", text) and text not in ("Any", "Array", "ArrayLike"):
        return f"class {text.rsplit('.', 1)[-1]}"
    return "object"


def differences(stub: dict[str, str], module: dict[str, str]) -> list[str]:
    """One sentence for each name that only one side has, or that is not the same on both."""
    found = [f"the stub names {name}, which the module has not" for name in sorted(set(stub) - set(module))]
    found += [f"the module has {name}, which the stub does not name" for name in sorted(set(module) - set(stub))]
    for name in sorted(set(stub) & set(module)):
        said, real = stub[name], module[name]
        # the binding says `object` of a value whose type it makes itself
        loose = real.startswith("property -> object") and said.split(",")[0] != "property -> str"
        if said != real and not (loose and said.count("set") == real.count("set")):
            found.append(f"{name}: the stub says {said}, the module {real}")
    return found


def stub_of(module: ModuleType) -> str:
    name = module.__name__.rsplit(".", 1)[1]
    return (Path(pliant.__file__).parent / f"{name}.pyi").read_text(encoding="utf-8")


@pytest.mark.parametrize("module", CORES, ids=lambda module: module.__name__)
def test_the_stub_of_a_core_is_the_core(module: ModuleType) -> None:
    assert differences(read_stub(stub_of(module)), read_module(module)) == []


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("hollow: bool = False", "hollow: bool = True"),  # another default
        ("hollow: bool = False", "outside: bool = False"),  # another name
        ("count: int, dt: float", "dt: float, count: int"),  # another order
        ("geom_a: int", "geom_a: float"),  # another type
        ("def slots(self) -> int", "def slots(self) -> str"),
        ("    def advance(", "    def go(self) -> int: ...\n    def advance("),  # too much
        ("BRISTLE_SIZE: int", "OTHER: int"),  # too little, and too much
    ],
)
def test_a_stub_that_is_wrong_is_noticed(old: str, new: str) -> None:
    text = stub_of(_contact)
    assert old in text
    assert differences(read_stub(text.replace(old, new, 1)), read_module(_contact))
