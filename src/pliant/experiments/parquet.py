"""Parquet files that are whole or not there, and that know who wrote them."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pliant import __version__
from pliant.errors import OutputError

if TYPE_CHECKING:
    import pyarrow as pa

_KEY = b"pliant"


def write_parquet(path: Path, table: pa.Table, about: Mapping[str, Any]) -> None:
    """Writes a table whole or not at all: the old file stays until the new one is complete.

    Args:
        path: the file.
        table: its rows.
        about: kept in the file's schema metadata as JSON, beside the version of pliant.

    Raises:
        OutputError: it cannot be written.
    """
    import pyarrow.parquet as pq

    marked = table.replace_schema_metadata({_KEY: json.dumps({**about, "version": __version__}, ensure_ascii=False)})
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
        OutputError: it does not exist, is damaged, or is not one of pliant's.
    """
    import pyarrow as pa
    import pyarrow.parquet as pq

    try:
        data = path.read_bytes()
    except OSError as error:
        raise OutputError(f"{path} cannot be read: {error.strerror or error}") from None
    try:
        # no threads of pyarrow's: one that still holds `data` when Python ends brings the process down
        with pq.ParquetFile(pa.BufferReader(data), pre_buffer=False, page_checksum_verification=True) as file:
            table = file.read(use_threads=False)
        metadata: dict[bytes, bytes] = table.schema.metadata or {}
        about = json.loads(metadata.get(_KEY, b"null"))
    except (pa.ArrowException, OSError, ValueError, OverflowError, MemoryError) as error:
        first = (str(error) or type(error).__name__).splitlines()[0].rstrip(".")
        raise OutputError(f"{path} is not a whole Parquet file: {first}") from None
    if not isinstance(about, dict) or not isinstance(about.get("version"), str):
        raise OutputError(f"{path} is a Parquet file, but not one of pliant's: its schema has no metadata 'pliant'")
    return table, about
