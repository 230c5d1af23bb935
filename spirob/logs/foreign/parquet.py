"""Numeric columns of a Parquet file of others.

Arrow's reader is native code that trusts what a file says of its own sizes, so a file that comes
from elsewhere is read in a process of its own.  What it unpacks to is counted before.
"""

from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from spirob.errors import DataError, MissingLog
from spirob.logs.bounds import check_table
from spirob.logs.foreign.apart import apart


def read_parquet_columns(path: Path | str) -> dict[str, np.ndarray]:
    """Columns by name, times in nanoseconds; raises MissingLog, and DataError if it is no use."""
    path = Path(path)
    if not path.is_file():
        raise MissingLog(f"{path}: there is no such log")
    try:
        return apart(_loaded, str(path.resolve()))
    except ValueError as error:
        raise DataError(f"{path}: this is no readable Parquet file: {error}") from None


def _loaded(path: str) -> dict[str, np.ndarray]:
    pa.set_memory_pool(pa.system_memory_pool())  # others reserve more than they use
    try:
        with pq.ParquetFile(path, page_checksum_verification=True) as file:
            check_table(file)
            table = file.read(use_threads=False)
        return {
            name: _numbers(table[name])
            for name in table.column_names
            if _is_numeric(table[name].type)
        }
    except pa.ArrowMemoryError:
        raise MemoryError from None


def _is_numeric(kind: pa.DataType) -> bool:
    temporal = pa.types.is_temporal(kind) and not pa.types.is_interval(kind)
    return bool(temporal or pa.types.is_integer(kind) or pa.types.is_floating(kind))


def _numbers(column: pa.ChunkedArray) -> np.ndarray:
    if pa.types.is_temporal(column.type):
        column = column.cast(pa.timestamp("ns")).cast(pa.int64())
    return np.asarray(column.to_numpy().astype(float))
