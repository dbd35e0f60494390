"""`pliant doctor`: checks the installation, a robot file, or a configuration."""

from __future__ import annotations

import importlib.metadata
import platform
import shutil
from pathlib import Path

from rich.console import Console
from rich.markup import escape
from rich.table import Table

from pliant import __version__
from pliant.errors import PliantError

_REQUIRED = (
    "numpy",
    "pin",
    "mujoco",
    "mink",
    "daqp",
    "pydantic",
    "typer",
    "rich",
    "matplotlib",
    "mcap",
    "mcap-ros2-support",
    "pyarrow",
)
_OPTIONAL = {
    "example-robot-data": "more robots: pip install 'pliant[robots]'",
    "crocoddyl": "second solver for predictive controllers: pip install 'pliant[crocoddyl]'",
    "distributed": "sweeps on a cluster: pip install 'pliant[cluster]'",
    "mim-solvers": "second solver for predictive controllers: pip install 'pliant[crocoddyl]'",
}
_COMPILED = (
    "_impedance",
    "_contact",
    "_estimation",
    "_guard",
    "_plant",
    "_references",
    "_telemetry",
    "_values",
    "_mpc",
)


def doctor_command(console: Console, config: Path | None) -> None:
    """Prints what is installed and whether it works; with a configuration, its warnings.

    Raises:
        PliantError: the configuration cannot be used at all.
    """
    if config is not None:
        _check_config(console, config)
        return
    table = Table(
        "what",
        "found",
        "",
        title=f"pliant {__version__} on Python {platform.python_version()}, {platform.machine()}",
        title_justify="left",
    )
    for name in _REQUIRED:
        version = _version(name)
        table.add_row(name, version or "–", "✓" if version else "✗ missing: pip install pliant")
    for name, use in _OPTIONAL.items():
        version = _version(name)
        table.add_row(name, version or "–", "✓" if version else escape(use))
    for name in _COMPILED:
        table.add_row(f"compiled core {name}", *map(escape, _compiled(name)))
    table.add_row("off-screen rendering", *_rendering())
    console.print(table)


def _check_config(console: Console, path: Path) -> None:
    from pliant.cli.choose import resolve

    choice = resolve(str(path) if path.suffix == ".toml" else f"{path}.toml", None, {}, [])
    study, config = choice.study, choice.config
    warnings = study.build(config).warnings
    for warning in warnings:
        console.print(f"warning: {warning}", style="yellow", markup=False, highlight=False, soft_wrap=True)
    if not warnings:
        console.print(
            f"{path}: nothing unsafe found (study {study.name!r}, case {config.case!r}, {config.controller!r})"
        )


def _version(name: str) -> str | None:
    try:
        return importlib.metadata.version(name)
    except importlib.metadata.PackageNotFoundError:
        return None


def _compiled(name: str) -> tuple[str, str]:
    try:
        module = importlib.import_module(f"pliant.{name}")
    except ImportError as error:
        compiler = "a C++ compiler is installed" if shutil.which("c++") else "install a C++17 compiler, e.g. g++"
        return "–", f"✗ {error}; reinstall pliant ({compiler})"
    return str(getattr(module, "isa", lambda: "")()) or "yes", "✓"


def _rendering() -> tuple[str, str]:
    from pliant.robot import Robot
    from pliant.simulation import MujocoPlant
    from pliant.simulation.snapshot import Camera, Snapshot, render

    try:
        plant = MujocoPlant(Robot.load("leg3"))
        drawn = render(plant.model, [Snapshot(plant.start)], Camera(), width=64, height=48)
    except (OSError, PliantError) as error:
        return "–", f"✗ {error}"
    return (
        ("yes", "✓") if drawn else ("–", "scenes are not drawn: install libegl1 or libosmesa6; everything else works")
    )
