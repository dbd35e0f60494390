"""Keeps the log of searches as text: `python benchmarks/searches.py OUT... --to docs/data/searches` after `--tune`."""

from __future__ import annotations

import argparse
import csv
from pathlib import Path

from pliant.experiments.parquet import read_parquet


def keep(folder: Path, to: Path) -> Path:
    """Writes a search's trials as CSV, what was asked for in the first line. Returns the file."""
    table, about = read_parquet(folder / "trials.parquet")
    path = to / f"{about['study']}-{about.get('case') or 'delayed'}-{about['controller']}.csv"
    with path.open("w", newline="", encoding="utf-8") as file:
        file.write("# " + ", ".join(f"{name} = {value}" for name, value in about.items()) + "\n")
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(table.column_names)
        for row in table.to_pylist():
            writer.writerow([f"{value:.5g}" if isinstance(value, float) else value for value in row.values()])
    return path


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folders", nargs="+", type=Path)
    parser.add_argument("--to", type=Path, required=True)
    chosen = parser.parse_args()
    chosen.to.mkdir(parents=True, exist_ok=True)
    for folder in chosen.folders:
        print(keep(folder, chosen.to))
