"""Compiled modules of another version than the Python beside them are refused when they are imported."""

import importlib
import subprocess
import sys
from pathlib import Path

import pytest

import pliant
from pliant import contract
from pliant.contract import StaleModuleError, agree, face_of, stale

MODULES = sorted(file.stem for file in Path(pliant.__file__).parent.glob("_[a-z]*.pyi"))
_RUN = """
import sys
import pliant.contract as contract
true_face = contract.face_of
contract.face_of = lambda module: {change} if module == "_plant" else true_face(module)
from pliant.cli.app import main
sys.argv = ["pliant", "run", "--show-config"]
main()
"""


@pytest.mark.parametrize("module", MODULES)
def test_a_compiled_module_has_the_number_of_its_face(module: str) -> None:
    face, shared = importlib.import_module(f"pliant.{module}").__contract__
    assert face == face_of(module) != ""
    assert shared == importlib.import_module("pliant._values").__contract__[1]


def test_another_face_and_other_shared_headers_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(contract, "_shared", {})
    agree("_mpc", face_of("_mpc"), "a")
    agree("_plant", face_of("_plant"), "a")
    with pytest.raises(StaleModuleError, match=r"pliant\._guard is of another version .* build pliant anew"):
        agree("_guard", face_of("_plant"), "a")
    with pytest.raises(StaleModuleError, match="another version"):
        agree("_guard", face_of("_guard"), "b")


def test_the_number_follows_what_is_offered_and_not_what_is_said(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(contract, "__file__", str(tmp_path / "contract.py"))
    texts = {
        "one": 'def fill(row: int) -> int:\n    """Fills a row."""\n',
        "said": 'def fill(row: int) -> int:  # of many\n    """Fills it."""\n',
        "other": 'def fill(row: int, at: int) -> int:\n    """Fills a row."""\n',
    }
    for name, text in texts.items():
        (tmp_path / f"_{name}.pyi").write_text(text, encoding="utf-8")
    assert face_of("_one") == face_of("_said")
    assert face_of("_one") != face_of("_other")
    assert face_of("_none") == ""
    agree("_none", "anything", next(iter(contract._shared.values())))  # nothing to compare it with


def test_a_name_that_a_module_lacks_is_told_as_its_version() -> None:
    with pytest.raises(ImportError) as missing:
        exec("from pliant._values import no_such_thing")
    assert stale(missing.value).startswith("compiled module pliant._values is of another version")
    with pytest.raises(ImportError) as other:
        exec("from pliant.frozen import no_such_thing")
    assert stale(other.value) == ""
    outer = RuntimeError("outer")
    outer.__cause__ = StaleModuleError("_mpc")
    assert "pliant._mpc" in stale(outer)


@pytest.mark.parametrize(("change", "code"), [("'another'", 2), ("true_face(module)", 0)])
def test_the_command_says_it_in_a_sentence(change: str, code: int) -> None:
    done = subprocess.run(
        [sys.executable, "-c", _RUN.format(change=change)], capture_output=True, text=True, check=False
    )
    assert done.returncode == code, done.stderr
    if code:
        sentence = done.stderr.strip()
        assert sentence.startswith("error: compiled module pliant._plant is of another version")
        assert "pip install ." in sentence
        assert "\n" not in sentence
    else:
        assert "error" not in done.stderr


def test_an_import_ends_with_the_sentence() -> None:
    code = "import pliant.contract as c\nc.face_of = lambda module: 'another'\nimport pliant._plant"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 1
    last = done.stderr.strip().splitlines()[-1]
    assert last.startswith("ImportError: compiled module pliant._plant is of another version")
