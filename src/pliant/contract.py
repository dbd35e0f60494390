"""Whether compiled modules belong to the Python beside them.

A module knows of which faces it was compiled: the number of its `.pyi` file, and one of the headers that compiled
modules share, as they pass each other objects. It asks here when it is imported. CMake runs this file for the numbers,
so it imports nothing of pliant.
"""

from __future__ import annotations

import hashlib
import re
import sys
from pathlib import Path

_SAID = re.compile(r'"""[\s\S]*?"""|#[^\n]*')
_OTHER = "is of another version than the Python beside it"
_shared: dict[str, str] = {}
"""module that was imported → number of the headers that it shares with others"""


class StaleModuleError(ImportError):
    """A compiled module of another version than the Python beside it.

    Args:
        module: its name.
    """

    def __init__(self, module: str) -> None:
        super().__init__(
            f"compiled module pliant.{module} {_OTHER}: build pliant anew, in its folder with `pip install .`",
            name=f"pliant.{module}",
        )


def face_of(module: str) -> str:
    """Number of what a compiled module offers, from its `.pyi` file without comments and docstrings; empty where there
    is no such file."""
    try:
        text = Path(__file__).with_name(f"{module}.pyi").read_text(encoding="utf-8")
    except OSError:
        return ""
    return hashlib.sha256(" ".join(_SAID.sub("", text).split()).encode()).hexdigest()[:16]


def agree(module: str, face: str, shared: str) -> None:
    """What a compiled module asks when it is imported.

    Args:
        module: its name, without the package.
        face: number of the face that it was compiled for.
        shared: number of the headers that it was compiled with.

    Raises:
        StaleModuleError: its face is another one, or a module that was imported before has other headers.
    """
    if face_of(module) not in ("", face) or any(shared != other for other in _shared.values()):
        raise StaleModuleError(module)
    _shared[module] = shared


def stale(error: BaseException) -> str:
    """Why an import failed, where it failed for a compiled module of another version; else empty."""
    seen: BaseException | None = error
    while seen is not None:
        if isinstance(seen, ImportError) and _OTHER in str(seen):
            return str(seen)
        if isinstance(seen, ImportError) and (seen.name or "").startswith("pliant._"):
            return str(StaleModuleError((seen.name or "").removeprefix("pliant.")))  # it lacks a name
        seen = seen.__cause__
    return ""


if __name__ == "__main__":
    sys.stdout.write(face_of(sys.argv[1]))
