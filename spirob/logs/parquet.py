"""A `Trace` as one Parquet file, and how large a table may be that is read at once.

The same trace gives the same bytes, so a hash of the file tells whether anything changed.
"""

import json
from collections.abc import Collection
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from spirob.errors import DataError, MissingChannel, MissingLog
from spirob.files import replacing
from spirob.trace import Trace

if TYPE_CHECKING:
    import pandas as pd

LARGEST = 2**29  # bytes


def check_table(file: pq.ParquetFile) -> None:
    """Raise ValueError where an open Parquet file claims too many numbers."""
    check_columns(file, None)


def check_columns(file: pq.ParquetFile, names: Collection[str] | None) -> None:
    """The same of some of its columns, named as they begin; None means all."""
    about = file.metadata
    groups = range(min(about.num_row_groups, 10_000))
    if names is None:
        columns = about.num_columns
        unpacked = sum(about.row_group(k).total_byte_size for k in groups)
    else:
        whole = [about.schema.column(c).path.partition(".")[0] for c in range(about.num_columns)]
        chosen = [c for c, name in enumerate(whole) if name in names]
        columns = len(chosen)
        unpacked = sum(
            about.row_group(k).column(c).total_uncompressed_size for k in groups for c in chosen
        )
    if max(8 * about.num_rows * columns, unpacked) > LARGEST:
        raise ValueError(f"it unpacks to more than {LARGEST >> 20} MiB")


def read_table(path: Path) -> "pd.DataFrame":
    """A table of numbers that the program wrote; raises ValueError where it claims too many."""
    with pq.ParquetFile(path) as file:
        check_table(file)
        return file.read().to_pandas()


TIME = "time_ns"
KEY = b"spirob"


def write_parquet(trace: Trace, path: Path | str) -> None:
    """Write a trace; raises DataError where its meta is not plain data."""
    about = {"name": trace.name, "units": dict(trace.units), "meta": dict(trace.meta)}
    try:
        text = json.dumps(about, ensure_ascii=False)
    except (TypeError, ValueError) as error:
        raise DataError(f"{trace.name}: meta cannot be kept as JSON: {error}") from error
    columns = {TIME: pa.array(np.asarray(trace.time_ns, np.int64))}
    for channel, values in trace.signals.items():
        columns[channel] = pa.array(np.asarray(values, np.float64))
    table = pa.table(columns).replace_schema_metadata({KEY: text.encode()})
    with replacing(path) as temporary:
        # Measured on a recorded trial: 36 % smaller and twice as fast as the default encoding.
        pq.write_table(
            table,
            temporary,
            compression="zstd",
            use_dictionary=False,
            use_byte_stream_split=True,
            write_page_checksum=True,
        )


def read_parquet(path: Path | str, channels: list[str] | None = None) -> Trace:
    """Read a trace, or only some of its channels.

    Raises MissingLog, MissingChannel, or DataError where the file is no trace or is corrupt.
    """
    if not Path(path).is_file():
        raise MissingLog(f"{path}: there is no such trace")
    try:
        with pq.ParquetFile(path, page_checksum_verification=True) as file:
            check_table(file)
            present = file.schema_arrow.names
            for channel in [TIME, *(channels or [])]:
                if channel not in present:
                    raise MissingChannel(str(path), channel, present)
            about = json.loads(file.schema_arrow.metadata[KEY])
            table = file.read(None if channels is None else [TIME, *channels])
        signals = {
            name: table[name].to_numpy().astype(np.float64, copy=False)
            for name in table.column_names
            if name != TIME
        }
        units = {name: str(about["units"].get(name, "")) for name in signals}
        time_ns = table[TIME].to_numpy().astype(np.int64, copy=False)
        return Trace(str(about["name"]), time_ns, signals, units, dict(about["meta"]))
    except MissingChannel:
        raise
    except DataError as error:
        raise DataError(f"{path}: {error}") from error
    except (pa.ArrowException, OSError, KeyError, TypeError, ValueError, AttributeError) as error:
        said = str(error).partition("\n")[0]
        raise DataError(f"{path}: this is no readable trace: {said}") from error
