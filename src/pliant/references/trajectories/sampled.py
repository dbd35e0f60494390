"""Trajectories sampled in a file: time, position and, if wanted, orientation."""

from __future__ import annotations

import io
import zipfile
import zlib
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from pliant.errors import ConfigError
from pliant.files import read_file, read_text
from pliant.references.trajectories.rotation import QuaternionSpline, Turning
from pliant.references.trajectories.spline import Spline
from pliant.references.trajectories.trajectory import Trajectory
from pliant.spatial import Array

COLUMNS = ("time", "x", "y", "z")
QUATERNION = ("qw", "qx", "qy", "qz")
_LARGEST = 1e9  # bytes
_NO_ARCHIVE = (ValueError, OSError, EOFError, SyntaxError, RuntimeError, zipfile.BadZipFile, zlib.error)
"""what a file that is no array, or a damaged one, makes NumPy and zipfile raise"""


@dataclass(frozen=True)
class SampledMotion:
    """A motion read from a file."""

    position: Trajectory
    """(3,) m, cubic spline through the samples"""
    rotation: Turning | None
    """None if the file has no orientation"""


def read_motion(path: str | Path) -> SampledMotion:
    """Reads a motion from a CSV or NPZ file.

    Args:
        path: CSV with a header line, or NPZ with arrays of these names: time (s), x, y, z (m) and, if the orientation
            is given, qw, qx, qy, qz (R_world_frame as a quaternion, scalar first). Time starts anywhere and increases.

    Returns:
        Its time zero is the first sample; after the last one it holds.

    Raises:
        OutputError: the file cannot be read.
        ConfigError: another ending, a missing column, not a number, times that do not increase, fewer than two rows.
    """
    file = Path(path)
    columns = _read_columns(file)
    known = (*COLUMNS, *QUATERNION)
    unknown = sorted(set(columns) - set(known))
    missing = [name for name in COLUMNS if name not in columns]
    given = [name for name in QUATERNION if name in columns]
    if given and len(given) < 4:
        missing += [name for name in QUATERNION if name not in columns]
    if missing or unknown:
        what = f"lacks {', '.join(missing)}" if missing else f"has unknown columns {', '.join(unknown)}"
        raise ConfigError(
            f"{file} {what}; a sampled trajectory has columns {', '.join(COLUMNS)}, optionally {', '.join(QUATERNION)}"
        )
    table = np.column_stack([columns[name] for name in (*COLUMNS, *given)])
    _check_table(file, table)
    times = table[:, 0] - table[0, 0]
    rotation = QuaternionSpline(times, table[:, 4:8]) if given else None
    return SampledMotion(Spline(times, table[:, 1:4]), rotation)


def _read_columns(file: Path) -> dict[str, Array]:
    if file.suffix.lower() not in (".csv", ".npz"):
        raise ConfigError(f"a sampled trajectory is a .csv or .npz file, got {file}")
    try:
        if file.suffix.lower() == ".npz":
            with np.load(io.BytesIO(read_file(file, _LARGEST))) as archive:
                return _equal_lengths(
                    file, {name: np.asarray(archive[name], dtype=np.float64) for name in archive.files}
                )
        return _parse_csv(file, read_text(file, _LARGEST))
    except _NO_ARCHIVE as error:
        raise ConfigError(f"{file} is not a sampled trajectory: {error}") from error


def _parse_csv(file: Path, text: str) -> dict[str, Array]:
    lines = [line for line in text.splitlines() if line.strip()]
    if not lines:
        raise ConfigError(f"{file} is empty; its first line names the columns: {', '.join(COLUMNS)}")
    names = [name.strip() for name in lines[0].split(",")]
    rows: list[list[float]] = []
    for number, line in enumerate(lines[1:], start=2):
        cells = line.split(",")
        try:
            rows.append([float(cell) for cell in cells])
        except ValueError as error:
            raise ConfigError(f"{file}, line {number}: {error}") from error
        if len(cells) != len(names):
            raise ConfigError(f"{file}, line {number}: {len(cells)} numbers for {len(names)} columns")
    table = np.array(rows, dtype=np.float64).reshape(-1, len(names))
    return {name: table[:, i] for i, name in enumerate(names)}


def _equal_lengths(file: Path, columns: dict[str, Array]) -> dict[str, Array]:
    shapes = {name: array.shape for name, array in columns.items()}
    if any(len(shape) != 1 for shape in shapes.values()) or len(set(shapes.values())) > 1:
        raise ConfigError(f"{file}: the arrays must be vectors of one length, got {shapes}")
    return columns


def _check_table(file: Path, table: Array) -> None:
    if table.shape[0] < 2:
        raise ConfigError(f"{file} must hold at least two samples, got {table.shape[0]}")
    if not np.isfinite(table).all():
        row, column = np.argwhere(~np.isfinite(table))[0]
        raise ConfigError(
            f"{file}: sample {row + 1} has a number that is not finite in column {(*COLUMNS, *QUATERNION)[column]}"
        )
    late = np.flatnonzero(np.diff(table[:, 0]) <= 0.0)
    if late.size:
        row = int(late[0])
        raise ConfigError(
            f"{file}: time must increase, but sample {row + 2} is at {table[row + 1, 0]:g} s after {table[row, 0]:g} s"
        )
    if table.shape[1] > 4 and np.any(np.linalg.norm(table[:, 4:8], axis=1) < 1e-3):
        raise ConfigError(f"{file}: a quaternion has no length")
