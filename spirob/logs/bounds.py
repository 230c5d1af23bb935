"""How large a table may be that is read at once: half a gigabyte of numbers."""

from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq

from spirob.errors import DataError

LARGEST = 2**29  # bytes
TEXT_LARGEST = 2**27  # bytes of text, which takes several times as much while it is read


def check_size(path: Path) -> None:
    """Raise DataError where a file would unpack to too much; what is no file passes."""
    if not path.is_file():
        return
    if path.suffix.lower() != ".parquet":
        if path.stat().st_size > TEXT_LARGEST:
            raise DataError(f"{path}: more than {TEXT_LARGEST >> 20} MiB of text; use Parquet")
        return
    try:
        with pq.ParquetFile(path) as file:
            check_table(file)
    except (pa.ArrowException, OSError, ValueError) as error:
        said = str(error).partition("\n")[0]
        raise DataError(f"{path}: this is no readable Parquet file: {said}") from None


def check_table(file: pq.ParquetFile) -> None:
    """Raise ValueError where an open Parquet file claims too many numbers."""
    about = file.metadata
    unpacked = sum(
        about.row_group(k).total_byte_size for k in range(min(about.num_row_groups, 10_000))
    )
    if max(8 * about.num_rows * about.num_columns, unpacked) > LARGEST:
        raise ValueError(f"it unpacks to more than {LARGEST >> 20} MiB")
