"""How large a table may be that is read at once: half a gigabyte of numbers."""

from collections.abc import Collection

import pyarrow.parquet as pq

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
