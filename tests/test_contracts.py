"""Contracts of the source tree: imports go down only, names resolve, nothing prints."""

from __future__ import annotations

import ast
import importlib
import pkgutil
import subprocess
import sys
from pathlib import Path

import pytest

import pliant

ROOT = Path(__file__).resolve().parent.parent
MODULES = sorted(
    module.name
    for module in pkgutil.walk_packages(pliant.__path__, "pliant.")
    if not module.name.rsplit(".", 1)[1].startswith("_render")
)


def lint(folder: Path) -> subprocess.CompletedProcess[str]:
    call = "from importlinter.cli import lint_imports_command; lint_imports_command()"
    command = [sys.executable, "-c", call, "--no-cache"]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False, timeout=120)


def test_imports_go_down_only() -> None:
    result = lint(ROOT)
    assert result.returncode == 0, result.stdout


def test_a_sideways_import_would_be_noticed(tmp_path: Path) -> None:
    """Baseline: a package with one forbidden import breaks the same contract."""
    for folder in ("controllers", "simulation"):
        (tmp_path / "toy" / folder).mkdir(parents=True)
        (tmp_path / "toy" / folder / "__init__.py").write_text("")
    (tmp_path / "toy" / "__init__.py").write_text("")
    (tmp_path / "toy" / "controllers" / "__init__.py").write_text("import toy.simulation\n")
    (tmp_path / "pyproject.toml").write_text(
        '[tool.importlinter]\nroot_package = "toy"\n[[tool.importlinter.contracts]]\nname = "layers"\ntype = "layers"\n'
        'layers = ["toy.controllers | toy.simulation"]\n'
    )
    assert lint(tmp_path).returncode != 0


@pytest.mark.parametrize("name", MODULES)
def test_every_public_name_resolves(name: str) -> None:
    try:
        module = importlib.import_module(name)
    except ImportError as error:  # an extra that is not installed
        if "crocoddyl" in name:
            pytest.skip(str(error))
        raise
    for public in getattr(module, "__all__", []):
        assert hasattr(module, public), f"{name}.__all__ names {public!r}, which does not exist"


def test_the_library_does_not_print() -> None:
    offenders: list[str] = []
    for path in sorted((ROOT / "src" / "pliant").rglob("*.py")):
        if "cli" in path.parts:
            continue
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "print":
                offenders.append(f"{path.relative_to(ROOT)}:{node.lineno}")
    assert not offenders


def imports_of(path: Path, modules: set[str]) -> set[str]:
    """Modules that a file names in an import: at its head, for types alone, and inside functions."""
    found: set[str] = set()
    for statement in ast.walk(ast.parse(path.read_text())):
        if isinstance(statement, ast.Import):
            found |= {alias.name for alias in statement.names}
        elif isinstance(statement, ast.ImportFrom) and statement.module and not statement.level:
            for alias in statement.names:
                whole = f"{statement.module}.{alias.name}"
                found.add(whole if whole in modules else statement.module)
    return found & modules


def circle_in(graph: dict[str, set[str]]) -> list[str]:
    """Modules that are left when those that import nothing of the rest are taken away again and again."""
    rest = dict(graph)
    while gone := {name for name, imported in rest.items() if not imported & rest.keys()}:
        rest = {name: imported for name, imported in rest.items() if name not in gone}
    while idle := rest.keys() - {name for imported in rest.values() for name in imported}:
        rest = {name: imported for name, imported in rest.items() if name not in idle}
    return sorted(rest)


def test_no_modules_import_each_other_in_a_circle() -> None:
    source = ROOT / "src"
    files = {
        ".".join(path.relative_to(source).with_suffix("").parts).removesuffix(".__init__"): path
        for path in (source / "pliant").rglob("*.py")
    }
    graph = {name: imports_of(path, set(files)) for name, path in files.items()}
    assert len(graph) > 300
    assert circle_in(graph) == []
    # Baseline: one import upwards closes a circle, and all of it is named.
    closed = graph | {"pliant.telemetry.summary": {*graph["pliant.telemetry.summary"], "pliant.experiments.case"}}
    assert {"pliant.experiments.case", "pliant.telemetry.summary"} <= set(circle_in(closed))


MOST_LINES, MOST_LINES_OF_A_FUNCTION = 250, 60


SOURCES, BESIDE = ("src/pliant", "cpp"), ("tests", "benchmarks", "examples")


def sources(folders: tuple[str, ...], *suffixes: str) -> list[Path]:
    return sorted(path for folder in folders for path in (ROOT / folder).rglob("*") if path.suffix in suffixes)


def long_files(paths: list[Path]) -> dict[str, int]:
    """Lines of the files that are longer than they may be."""
    lines = {path: len(path.read_text(encoding="utf-8").splitlines()) for path in paths}
    return {
        str(path.relative_to(ROOT) if path.is_relative_to(ROOT) else path.name): count
        for path, count in lines.items()
        if count > MOST_LINES
    }


def long_functions(path: Path) -> list[str]:
    """Functions of a file, as FILE:NAME, that are longer than they may be."""
    return [
        f"{path.relative_to(ROOT) if path.is_relative_to(ROOT) else path.name}:{node.name}"
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef))
        and (node.end_lineno or node.lineno) - node.lineno + 1 > MOST_LINES_OF_A_FUNCTION
    ]


def test_files_and_functions_are_short() -> None:
    files = sources(SOURCES, ".py", ".hpp", ".cpp")
    assert len(files) > 300  # it found them
    assert long_files(files) == {}
    assert {name for path in sources(SOURCES, ".py") for name in long_functions(path)} == set()


@pytest.mark.parametrize("folder", BESIDE)
def test_files_and_functions_beside_the_package_are_short(folder: str) -> None:
    files = sources((folder,), ".py")
    assert len(files) > 5  # it found them
    assert long_files(files) == {}
    assert {name for path in files for name in long_functions(path)} == set()


def test_a_long_file_would_be_noticed(tmp_path: Path) -> None:
    path = tmp_path / "long.py"
    for lines, found in ((MOST_LINES, {}), (MOST_LINES + 1, {"long.py": MOST_LINES + 1})):
        path.write_text("pass\n" * lines)
        assert long_files([path]) == found


def test_a_long_function_would_be_noticed(tmp_path: Path) -> None:
    path = tmp_path / "long.py"
    for statements, found in ((MOST_LINES_OF_A_FUNCTION - 1, []), (MOST_LINES_OF_A_FUNCTION, ["long.py:long"])):
        path.write_text("def long() -> None:\n" + "    pass\n" * statements)
        assert long_functions(path) == found
