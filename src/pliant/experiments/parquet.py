"""Parquet files that are written atomically, with metadata and a digest."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pliant import __version__
from pliant.errors import OutputError
from pliant.files import read_file

if TYPE_CHECKING:
    import pyarrow as pa

_KEY = b"pliant"


def write_parquet(path: Path, table: pa.Table, about: Mapping[str, Any]) -> None:
    """Writes a table atomically: the old file stays until the new one is complete.

    Args:
        path: the file.
        table: its rows.
        about: stored in the file's schema metadata as JSON, with the version of pliant and a digest of everything.

    Raises:
        OutputError: it cannot be written.
    """
    import pyarrow.parquet as pq

    about = {**about, "version": __version__}
    about["digest"] = _digest(table, about)
    marked = table.replace_schema_metadata({_KEY: json.dumps(about, ensure_ascii=False)})
    beside = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        pq.write_table(marked, beside, compression="zstd", write_page_checksum=True)
        os.replace(beside, path)
    except OSError as error:
        beside.unlink(missing_ok=True)
        raise OutputError(f"{path} cannot be written: {error.strerror or error}") from error


def read_parquet(path: Path) -> tuple[pa.Table, dict[str, Any]]:
    """Reads a file that `write_parquet` wrote.

    Returns:
        The rows, and what the file says about itself.

    Raises:
        OutputError: it does not exist, is damaged, is not one of pliant's, or was changed since this version of pliant
            wrote it.
    """
    import pyarrow as pa
    import pyarrow.parquet as pq

    data = read_file(path)
    try:
        # without threads of pyarrow's, which may still hold `data` when Python ends
        with pq.ParquetFile(pa.BufferReader(data), pre_buffer=False, page_checksum_verification=True) as file:
            table = file.read(use_threads=False)
        metadata: dict[bytes, bytes] = table.schema.metadata or {}
        about = json.loads(metadata.get(_KEY, b"null"))
        digest = about.pop("digest", None) if isinstance(about, dict) else None
        whole = isinstance(about, dict) and digest == _digest(table, about)
    except (pa.ArrowException, OSError, ValueError, OverflowError, MemoryError) as error:
        first = (str(error) or type(error).__name__).splitlines()[0].rstrip(".")
        raise OutputError(f"{path} is not a whole Parquet file: {first}") from None
    if not isinstance(about, dict) or not isinstance(about.get("version"), str):
        raise OutputError(f"{path} is a Parquet file, but not one of pliant's: its schema has no metadata 'pliant'")
    if not whole and about["version"] == __version__:
        raise OutputError(f"{path} was changed after pliant wrote it, or is damaged: its digest does not fit")
    return table, about


def _digest(table: pa.Table, about: Mapping[str, Any]) -> str:
    """Parquet's checksums cover the pages alone, not what the file says about them."""
    text = f"{table.column_names!r}\n{table.to_pylist()!r}\n{json.dumps(dict(about), sort_keys=True)}"
    return hashlib.sha256(text.encode("utf-8", "backslashreplace")).hexdigest()
