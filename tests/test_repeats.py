"""Nothing of the package stands in two places: no long run of equal lines, no two functions that do the same."""

from __future__ import annotations

import ast
import re
from collections import defaultdict
from collections.abc import Iterable
from itertools import pairwise
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
MOST_LINES = 10
"""that two places share in a row"""
MOST_LINES_OF_A_BODY = 5
"""of two functions that are the same but for the names of their variables"""

MOST_DEFAULTS = 3
"""numbers that a configuration and the class it configures may not both give"""

Code = list[tuple[int, str]]
"""number and text of the lines that count"""


def code_of(path: Path) -> Code:
    """Lines without comments, docstrings, imports and lone punctuation; white space is folded."""
    text = path.read_text(encoding="utf-8")
    silent: set[int] = set()
    if path.suffix in (".py", ".pyi"):
        for node in ast.walk(ast.parse(text)):
            said = isinstance(node, ast.Expr) and isinstance(getattr(node.value, "value", None), str)
            if said or isinstance(node, (ast.Import, ast.ImportFrom)):
                silent |= set(range(node.lineno, (node.end_lineno or node.lineno) + 1))
    lines = ((number, re.sub(r"(#|//).*$", "", line)) for number, line in enumerate(text.splitlines(), 1))
    folded = ((number, " ".join(line.split())) for number, line in lines if number not in silent)
    return [(number, line) for number, line in folded if re.search(r"\w", line)]


def repeats(files: dict[str, Code], most: int = MOST_LINES) -> list[str]:
    """Pairs of places that share more than so many lines in a row, each once, where the run begins."""
    seen: dict[tuple[str, ...], list[tuple[str, int]]] = defaultdict(list)
    for name, code in files.items():
        for start in range(len(code) - most):
            seen[tuple(line for _, line in code[start : start + most + 1])].append((name, start))
    found = [(one, other) for places in seen.values() for one, other in pairwise(places)]
    pairs = set(found)
    begins = [
        (one, other) for one, other in found if ((one[0], one[1] - 1), (other[0], other[1] - 1)) not in pairs
    ]  # where a longer run begins
    return [" ~ ".join(f"{name}:{files[name][start][0]}" for name, start in pair) for pair in begins]


class Renamed(ast.NodeTransformer):
    """Gives names of variables and arguments the number in which they first appear."""

    def __init__(self) -> None:
        self.names: dict[str, str] = {}

    def visit_Name(self, node: ast.Name) -> ast.Name:
        return ast.Name(self.names.setdefault(node.id, str(len(self.names))), ast.Load())


def twins(files: Iterable[Path], most: int = MOST_LINES_OF_A_BODY) -> list[list[str]]:
    """Functions of more than so many lines that are the same but for names, as FILE:NAME."""
    found: dict[str, list[str]] = defaultdict(list)
    for path in files:
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if not isinstance(node, ast.FunctionDef):
                continue
            body = node.body[1:] if ast.get_docstring(node) is not None else node.body
            if sum((part.end_lineno or 0) - part.lineno + 1 for part in body) > most:
                same = ast.dump(Renamed().visit(ast.Module(body, [])))
                found[same].append(f"{path.name}:{node.name}")
    return [places for places in found.values() if len(places) > 1]


def defaults(node: ast.ClassDef) -> dict[str, float]:
    """Field → number that stands as its default in the text of a class, by itself or in a call of `quantity`."""
    found: dict[str, float] = {}
    for field in node.body:
        if not (isinstance(field, ast.AnnAssign) and isinstance(field.target, ast.Name)):
            continue
        value = field.value
        if isinstance(value, ast.Call):
            given = [one.value for one in value.keywords if one.arg == "default"]
            value = (value.args or given or [None])[0]
        if isinstance(value, ast.Constant) and type(value.value) in (int, float):
            found[field.target.id] = value.value
    return found


def given_twice(files: Iterable[Path]) -> list[str]:
    """Pairs of a configuration and a plain class that give three fields or more the same default, each by itself."""
    plain: dict[str, dict[str, float]] = {}
    typed: dict[str, dict[str, float]] = {}
    for path in files:
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ClassDef):
                made = {getattr(one.func, "id", "") for one in ast.walk(node) if isinstance(one, ast.Call)}
                (typed if made & {"quantity", "Field"} else plain)[node.name] = defaults(node)
    shared = {(one, two): set(a.items()) & set(b.items()) for one, a in typed.items() for two, b in plain.items()}
    return [f"{one} ~ {two}" for (one, two), both in shared.items() if len(both) >= MOST_DEFAULTS]


def sources(*suffixes: str) -> list[Path]:
    return sorted(
        path for folder in ("src/pliant", "cpp") for path in (ROOT / folder).rglob("*") if path.suffix in suffixes
    )


def test_no_two_places_share_a_long_run_of_lines() -> None:
    files = {str(path.relative_to(ROOT)): code_of(path) for path in sources(".py", ".pyi", ".hpp", ".cpp")}
    assert len(files) > 300  # it found them
    assert repeats(files) == []


def test_no_two_functions_do_the_same() -> None:
    assert twins(sources(".py")) == []


def test_defaults_stand_once() -> None:
    assert given_twice(sources(".py")) == []


def test_defaults_that_stand_twice_would_be_noticed(tmp_path: Path) -> None:
    plain = "class Spring:\n    k: float = 1.0\n    d: float = 2.0\n    n: int = 3\n\n\n"
    fields = (
        'k: float = quantity(1.0, "N/m", "K")',
        'd: float = quantity(2.0, "N s/m", "D")',
        "n: int = Field(default={n})",
    )
    file = tmp_path / "spring.py"
    for n, found in (("3", ["SpringConfig ~ Spring"]), ("Spring.n", [])):
        file.write_text(f"{plain}class SpringConfig(Config):\n    " + "\n    ".join(fields).format(n=n))
        assert given_twice([file]) == found


def test_a_run_that_stands_twice_would_be_noticed(tmp_path: Path) -> None:
    """Baseline: eleven lines copied into another function, with a comment and another indentation, are found."""
    lines = [f"x_{k} = {k} * scale" for k in range(MOST_LINES + 1)]
    once, twice = tmp_path / "once.py", tmp_path / "twice.py"
    once.write_text("def one(scale):\n" + "".join(f"    {line}  # said\n" for line in lines) + "    return x_1\n")
    twice.write_text("if True:\n    def other(scale):\n" + "".join(f"        {line}\n\n" for line in lines))
    files = {path.name: code_of(path) for path in (once, twice)}
    assert repeats(files) == ["once.py:2 ~ twice.py:3"]
    files["twice.py"].pop(3)  # one line less in a row
    assert repeats(files) == []


def test_a_function_that_only_renames_would_be_noticed(tmp_path: Path) -> None:
    body = "".join(
        f"    {line}\n"
        for line in ("a = {0} + 1", "b = a * {0}", "c = b - a", "d = c / {0}", "e = d ** 2", "return a + b + c + d + e")
    )
    other = tmp_path / "two.py"
    other.write_text(f"def f(x):\n{body.format('x')}\ndef g(size):\n{body.format('size')}")
    assert twins([other]) == [["two.py:f", "two.py:g"]]
    other.write_text(f"def f(x):\n{body.format('x')}\ndef g(size):\n{body.format('size').replace('a *', 'a /')}")
    assert twins([other]) == []
