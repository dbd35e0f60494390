"""Paths from files: CSV with named columns, and the GOTO statements of APT cutter-location data."""

from __future__ import annotations

import csv
import io
import math
import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from pliant.errors import ConfigError, options
from pliant.files import read_text
from pliant.spatial import Array

_COLUMNS = ("time", "x", "y", "z", "force", "speed")
_LENGTHS = {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "in": 0.0254}
_UNITS = {**_LENGTHS, "s": 1.0, "ms": 1e-3, "n": 1.0, "m/s": 1.0, "mm/s": 1e-3, "mm/min": 1e-3 / 60.0}
_LARGEST = 1e7  # bytes; a path of a million points
_HEADER = re.compile(r"^\s*([A-Za-z]+)\s*(?:[\[(_ ]\s*([A-Za-z/]+)\s*[\])]?)?\s*$")


@dataclass(frozen=True)
class PathPoints:
    """Points of a path file. SI units, in the axes of the file."""

    points: Array
    """(k, 3) m; z is 0 where the file has none"""
    flat: bool
    """the file gives x and y only"""
    lines: tuple[int, ...]
    """(k,) line of each point in the file"""
    time: Array | None = None
    """(k,) s"""
    speed: Array | None = None
    """(k,) m/s"""
    force: Array | None = None
    """(k,) N"""


def read_path(file: Path, unit: str = "m") -> PathPoints:
    """Reads a path.

    Args:
        file: `.csv` with a header line (x and y, in any order, among them if wanted z, time, speed, force; others are
            passed over; `x [mm]` or `x_mm` gives a column's unit), or APT (`.apt`, `.cl`, `.cls`, `.ncl`, `.aptsource`:
            GOTO, FEDRAT in mm/min, UNITS).
        unit: of lengths that the file gives no unit for: "m", "mm", "cm" or "in".

    Raises:
        OutputError: the file cannot be read.
        ConfigError: another ending, a missing column, a line that cannot be read (with its number), too few points.
    """
    if unit not in _LENGTHS:
        raise ConfigError(f"unknown unit {unit!r} of a path file; {options(_LENGTHS, unit)}")
    text = read_text(file, _LARGEST)
    if file.suffix.lower() == ".csv":
        found = _csv(file, text, _UNITS[unit])
    elif file.suffix.lower() in (".apt", ".cl", ".cls", ".ncl", ".aptsource"):
        found = _apt(file, text, "mm" if unit == "m" else unit)
    else:
        raise ConfigError(f"a path file is a .csv, or APT as .apt, .cl, .cls, .ncl or .aptsource, got {file}")
    if len(found.points) < 2:
        raise ConfigError(f"{file} must hold at least two points, got {len(found.points)}")
    return found


def _csv(file: Path, text: str, length: float) -> PathPoints:
    rows = _rows(file, text)
    header = rows[0][1] if rows else []
    if not header:
        raise ConfigError(
            f"{file} is empty; its first line names the columns: x, y and, if wanted, z, time, speed, force"
        )
    places, scales = _places(file, header, length)
    columns: dict[str, list[float]] = {name: [] for name in places}
    lines: list[int] = []
    for line, row in rows[1:]:
        if not any(cell.strip() for cell in row):
            continue
        lines.append(line)
        for name, place in places.items():
            columns[name].append(_number(file, line, name, row, place) * scales[name])
    table = {name: np.array(values) for name, values in columns.items()}
    if "time" in table:
        late = np.flatnonzero(np.diff(table["time"]) <= 0.0)
        if late.size:
            raise ConfigError(f"{file}, line {lines[int(late[0]) + 1]}: time must increase from row to row")
    for name in ("force", "speed"):
        low = np.flatnonzero(table[name] < 0.0) if name in table else np.empty(0, dtype=np.intp)
        if low.size:
            why = "a force on a surface pushes" if name == "force" else "the order of the rows is the direction"
            raise ConfigError(
                f"{file}, line {lines[int(low[0])]}: column {name!r} must not be negative, got"
                f" {table[name][low[0]]:g}: {why}"
            )
    z = table.get("z")
    points = np.column_stack([table["x"], table["y"], np.zeros(len(lines)) if z is None else z])
    return PathPoints(points, z is None, tuple(lines), table.get("time"), table.get("speed"), table.get("force"))


def _rows(file: Path, text: str) -> list[tuple[int, list[str]]]:
    """Number of the line and cells of every row."""
    rows = csv.reader(io.StringIO(text))
    try:
        return [(rows.line_num, row) for row in rows]
    except csv.Error as error:  # a cell without an end, for one
        raise ConfigError(f"{file} is not CSV: {error}") from None


def _places(file: Path, header: list[str], length: float) -> tuple[dict[str, int], dict[str, float]]:
    places: dict[str, int] = {}
    scales: dict[str, float] = {}
    for place, cell in enumerate(header):
        match = _HEADER.match(cell)
        name = match[1].lower() if match else ""
        if name not in _COLUMNS:
            continue
        if name in places:
            raise ConfigError(f"{file}, line 1: column {name!r} stands there twice")
        given = match[2].lower() if match and match[2] else None
        if given is not None and given not in _UNITS:
            raise ConfigError(f"{file}, line 1: unknown unit {given!r} of column {name!r}; valid: {', '.join(_UNITS)}")
        places[name] = place
        scales[name] = _UNITS[given] if given else length if name in ("x", "y", "z", "speed") else 1.0
    missing = [name for name in ("x", "y") if name not in places]
    if missing:
        raise ConfigError(
            f"{file}, line 1: no column {' and no column '.join(missing)}; the first line names the columns, such as"
            f" x,y,z or time,x,y, got {', '.join(header)[:80]!r}"
        )
    return places, scales


def _number(file: Path, line: int, name: str, row: list[str], place: int) -> float:
    text = row[place].strip() if place < len(row) else ""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise ConfigError(f"{file}, line {line}: column {name!r} must be a finite number, got {text!r}")
    return value


def _apt(file: Path, text: str, unit: str) -> PathPoints:
    scale, feed = _UNITS[unit], math.nan
    points: list[tuple[float, ...]] = []
    speeds: list[float] = []
    lines: list[int] = []
    for number, raw in enumerate(text.splitlines(), start=1):
        word, slash, rest = raw.split("$$")[0].strip().upper().partition("/")
        word = word.strip()
        if not slash:
            continue
        if word == "UNITS":
            scale = _UNITS["in" if "INCH" in rest else "cm" if "CM" in rest else "mm"]
        elif word == "FEDRAT":
            values = [part for part in rest.split(",") if _is_number(part)]
            if not values:
                raise ConfigError(f"{file}, line {number}: FEDRAT needs a number, got {raw.strip()!r}")
            feed = float(values[0]) * scale / 60.0
        elif word == "GOTO":
            values = rest.split(",")
            if len(values) not in (3, 6) or not all(_is_number(part) for part in values):
                raise ConfigError(f"{file}, line {number}: GOTO/x,y,z or GOTO/x,y,z,i,j,k, got {raw.strip()!r}")
            points.append(tuple(float(part) * scale for part in values[:3]))
            speeds.append(feed)
            lines.append(number)
    speed = np.array(speeds)
    known = bool(len(speed)) and bool(np.isfinite(speed).all()) and bool((speed > 0.0).all())
    return PathPoints(np.array(points).reshape(-1, 3), False, tuple(lines), None, speed if known else None)


def _is_number(text: str) -> bool:
    try:
        return math.isfinite(float(text))
    except ValueError:
        return False
