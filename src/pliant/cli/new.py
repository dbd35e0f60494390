"""`pliant new`: writes template files."""

from __future__ import annotations

import keyword
import re
from importlib.resources import files
from pathlib import Path

from rich.console import Console

from pliant.errors import ConfigError, OutputError, options
from pliant.telemetry.output import write_text

_KINDS = {"controller": "MyController"}
"""kind → name in its template that the user's name replaces"""


def new_command(console: Console, what: str, name: str, out: Path | None) -> None:
    """Writes a template and its test under a name.

    Raises:
        ConfigError: there is no such template, or the name is not one of a Python class.
        OutputError: a file already exists, or cannot be written.
    """
    if what not in _KINDS:
        raise ConfigError(f"there is no template {what!r}; {options([*_KINDS, 'task'], what)}")
    if not name.isidentifier() or keyword.iskeyword(name):
        raise ConfigError(f"a controller's name is that of a Python class, for example SoftSpring, got {name!r}")
    taken = set(re.findall(r"\w+", _template(f"{what}.py") + _template(f"test_{what}.py"))) - {_KINDS[what]}
    if name in taken:
        raise ConfigError(f"{name} is a name that the template uses itself: call your controller something else")
    path = out or Path(f"{_snake(name)}.py")
    if path.suffix != ".py" or not path.stem.isidentifier():
        raise ConfigError(f"a controller goes into a Python file that can be imported, got {path}")
    test = path.with_name(f"test_{path.name}")
    for file in (path, test):
        if file.exists():
            raise OutputError(f"{file} already exists; choose another name with -o")
    for file, template in ((path, f"{what}.py"), (test, f"test_{what}.py")):
        text = _template(template)
        write_text(file, text.replace("my_controller.py", path.name).replace(_KINDS[what], name))
    console.print(
        f"controller  {path}\ntest        {test}\n\ntry         pliant run stack --controller {path}:{name}"
        f"\n            python -m pytest {test}",
        markup=False, highlight=False, soft_wrap=True,
    )  # fmt: skip


def _template(name: str) -> str:
    return files("pliant.templates").joinpath(name).read_text(encoding="utf-8")


def _snake(name: str) -> str:
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", name).lower()
