"""`pliant list controllers NAME`: what one controller needs, its parameters, and where it was found to hold the
force."""

from __future__ import annotations

import json
from typing import Any

from pydantic_core import to_jsonable_python
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from pliant.dotted import flat
from pliant.entries import ControllerEntry
from pliant.experiments.origins import leaves
from pliant.quantity import unit_of
from pliant.wiring.domains import HOLDS, DomainRun, trials

_LONGEST = 30  # characters of a value


def print_controller(console: Console, entry: ControllerEntry[Any]) -> None:
    """Prints the details of a controller, by its name or as `module:Class`."""
    regulates = "regulates the contact force" if entry.regulates_force else "regulates no force"
    facts = {
        "what it is": f"{entry.summary}; {regulates}",
        "family": entry.family,
        "needs": ", ".join(entry.needs(entry.default).words()) or "joint positions and velocities",
        "guarantees": entry.guarantees,
        "fixed": ", ".join(f"{key} = {value}" for key, value in flat(entry.fixed).items()) or "–",
    }
    facts_table = Table(title=escape(entry.name), title_justify="left", show_header=False)
    for what, text in facts.items():
        facts_table.add_row(what, escape(text))
    console.print(facts_table)
    console.print(_parameters(entry))
    found = [one for one in trials() if one.controller == entry.name]
    if found:
        _print_domain(console, found)
        _print_fixed(console, entry, found)
    else:
        console.print(f"where {entry.name} holds was not measured", markup=False, highlight=False, soft_wrap=True)


def _parameters(entry: ControllerEntry[Any]) -> Table:
    table = Table(title="parameters before a robot and a task change them", title_justify="left")
    for heading in ("key after control.", "value", "unit", "what it is"):
        table.add_column(heading, overflow="fold")
    for path, value, about, _ in leaves(entry.default):
        text = json.dumps(to_jsonable_python(value), ensure_ascii=False)
        text = text if len(text) <= _LONGEST else f"{text[: _LONGEST - 1]}…"
        table.add_row(*map(escape, (".".join(path), text, unit_of(about), about.description or "")))
    return table


def _print_domain(console: Console, found: list[DomainRun]) -> None:
    """Rows: robot and delay; columns: stiffness of the surface; below the table, the reasons where it does not hold."""
    table = Table(
        title="where it holds with suggested gains: 20 N on a plane, 0.05 m/s, drives of 30 Hz, friction 0.25",
        title_justify="left",
    )
    columns = sorted({one.stiffness for one in found})
    table.add_column("robot")
    table.add_column("delay, ms", justify="right")
    for stiffness in columns:
        table.add_column(f"{stiffness:g} N/m")
    verdicts = {(one.robot, one.delay, one.stiffness): one.verdict for one in found}
    reasons = list(dict.fromkeys(one.verdict for one in found if one.verdict != HOLDS))
    places = {one.robot: f"{one.robot}, {one.place}" for one in found if one.place}
    for robot, delay in dict.fromkeys((one.robot, one.delay) for one in found):
        cells = [verdicts.get((robot, delay, stiffness)) for stiffness in columns]
        table.add_row(places.get(robot, robot), f"{1e3 * delay:g}", *(_cell(cell, reasons) for cell in cells))
    console.print(table)
    for number, reason in enumerate(reasons, start=1):
        console.print(f"({number}) {reason}", markup=False, highlight=False)


def _print_fixed(console: Console, entry: ControllerEntry[Any], found: list[DomainRun]) -> None:
    """Where a controller fails, what of it no suggestion changes."""
    fixed = ", ".join(f"{key} = {value}" for key, value in flat(entry.fixed).items())
    if fixed and any(one.verdict != HOLDS for one in found):
        told = f"{entry.name} is defined by {fixed}: what is suggested changes its gains, not this"
        console.print(told, markup=False, highlight=False, soft_wrap=True)


def _cell(verdict: str | None, reasons: list[str]) -> str:
    if verdict is None:
        return "–"
    return "yes" if verdict == HOLDS else f"no ({reasons.index(verdict) + 1})"
