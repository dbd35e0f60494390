"""`pliant bench`: how long one step takes."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table

from pliant.errors import ConfigError, options
from pliant.telemetry.output import write_text


def bench_command(console: Console, what: str, file: Path | None) -> None:
    """Runs a benchmark and prints percentiles.

    Raises:
        ConfigError: there is no benchmark of that name.
        OutputError: the JSON file cannot be written.
    """
    if what not in _BENCHES:
        raise ConfigError(f"there is no benchmark {what!r}; {options(_BENCHES, what)}")
    result = _BENCHES[what](console)
    if file is not None:
        write_text(file, json.dumps(result, indent=2, ensure_ascii=False) + "\n")


def _controllers(console: Console) -> dict[str, Any]:
    from pliant.controllers.benchmark import run as run_stack
    from pliant.studies.haptic.benchmark import run as run_haptic

    result = run_stack()
    _print_percentiles(console, f"two-task stack on 7 joints, {result['steps']} steps", result)
    haptic = run_haptic()
    title = f"haptic controller on 3 joints (planner, exploration, impedance, torques), {haptic['steps']} steps"
    _print_percentiles(console, title, haptic)
    return {**result, "haptic": haptic}


def _print_percentiles(console: Console, title: str, result: Mapping[str, Any]) -> None:
    table = Table("µs per step", "median", "p90", "p99", "max", title=title, title_justify="left")
    for clock in ("cpu", "wall"):
        table.add_row(f"{clock} time", *(f"{result[clock][name]:.1f}" for name in ("median", "p90", "p99", "max")))
    console.print(table)


def _mpc(console: Console) -> dict[str, Any]:
    from pliant.mpc.benchmark import run

    result = run()
    title = f"predictive controllers, {result['robot']}, N = {result['horizon']}, {result['instruction_set']}"
    table = Table(
        "CPU µs",
        "node",
        "iteration",
        "median",
        "p90",
        "p99",
        "max",
        "iterations",
        "yardsticks",
        title=title,
        title_justify="left",
    )
    for name, case in result["cases"].items():
        for label, part in ((name, "hot"), ("  after a pause of 2 ms", "paused")):
            cpu = [f"{case[part]['cpu'][key]:.1f}" for key in ("median", "p90", "p99", "max")]
            node = f"{case['node']['calc_and_derivatives']:.2f}" if part == "hot" else ""
            iteration, count = case[part]["per_iteration"]["median"], case[part]["iterations"]["mean"]
            table.add_row(label, node, f"{iteration:.1f}", *cpu, f"{count:.2f}", f"{case[part]['in_yardsticks']:.1f}")
    console.print(table)
    console.print(f"yardstick: {result['yardstick']['what']}, {result['yardstick']['median']:.1f} µs", highlight=False)
    if "cpu" in result["bridge"]:
        console.print(
            f"beside it: {result['bridge']['what']}, {result['bridge']['cpu']['median']:.0f} µs", highlight=False
        )
    return result


def _loop(console: Console) -> dict[str, Any]:
    from pliant.experiments.benchmark import run

    result = run()
    table = Table("", *result, title="whole loops: CPU µs a tick, then s", title_justify="left")
    for row in next(iter(result.values())):
        digits = 2 if row in ("loop", "run") or row.startswith(("rollout", "gain")) else 1
        table.add_row(_LOOP_ROWS.get(row, row), *(f"{case[row]:.{digits}f}" for case in result.values()))
    console.print(table)
    return result


_LOOP_ROWS = {"loop": "loop, CPU s per simulated s", "run": "whole run, CPU s"}
"""row → its label; what is not here is called as it is"""
_BENCHES: Mapping[str, Callable[[Console], dict[str, Any]]] = {
    "controllers": _controllers,
    "loop": _loop,
    "mpc": _mpc,
}
