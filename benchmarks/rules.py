"""Writes the tables of docs/suggestions.md: `python benchmarks/rules.py --write docs/suggestions.md`."""

from __future__ import annotations

import argparse
from collections.abc import Iterable
from pathlib import Path

from tasks import put_into

from pliant.rules import Rule
from pliant.studies.task.landing import RULES as LANDING_RULES
from pliant.wiring.noise import RULES as NOISE_RULES
from pliant.wiring.registry import controllers


def table(rules: Iterable[Rule]) -> str:
    """One row for each rule."""
    rows = [f"| `{rule.keys}` | {rule.says} | {rule.source} |" for rule in rules]
    return "\n".join(["| key | rule | from |", "|---|---|---|", *rows]).replace("|  |", "| – |")


def tables() -> str:
    """A table for the task itself and one for each family of controllers."""
    families: dict[str, tuple[tuple[Rule, ...], list[str]]] = {}
    for name, entry in controllers().items():
        if entry.rules:
            families.setdefault(entry.family, (entry.rules, []))[1].append(f"`{name}`")
    parts = ["**The task and its estimators**", table((*LANDING_RULES, *NOISE_RULES))]
    for rules, names in families.values():
        parts += [f"**{', '.join(names)}**", table(rules)]
    return "\n\n".join(parts)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--write", type=Path, help="page whose tables are replaced")
    page = parser.parse_args().write
    if page is None:
        print(tables())
    else:
        put_into(page, "rules", tables())


if __name__ == "__main__":
    main()
