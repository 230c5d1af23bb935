"""Parquet.  What a file unpacks to is counted before, and a large one gives what is wanted."""

from typing import TYPE_CHECKING

import numpy as np

from spirob.logs.readers.columns import Asked, Table, tell_twice

if TYPE_CHECKING:
    import pyarrow as pa
    import pyarrow.parquet as pq

KIND = "Parquet file"
SUFFIXES = {".parquet", ".pq"}
NEEDS = ("pyarrow.parquet",)

LIGHT = 2**26  # bytes beyond which only what is wanted is read


def read(asked: Asked) -> Table:
    """Numbers, times, and of nested columns those of one shape: `pose.x`, `position[0]`."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    from spirob.logs.trace import check_columns

    pa.set_memory_pool(pa.system_memory_pool())  # others reserve more than they use
    table = Table(asked.name)
    try:
        with (
            asked.path.open("rb") as raw,
            pq.ParquetFile(raw, page_checksum_verification=True) as file,
        ):
            some = _some(file, asked.wanted)
            check_columns(file, some)
            table.others = [n for n in file.schema_arrow.names if some and n not in some]
            found = file.read(columns=some, use_threads=False)
        for _ in range(4):  # structures within structures
            found = found.flatten()
        names = found.column_names
        for name in dict.fromkeys(names):
            _take(table, name, found.column(names.index(name)))
        tell_twice(table, names)
    except pa.ArrowMemoryError:
        raise MemoryError from None
    return table


def _some(file: "pq.ParquetFile", wanted: tuple[str, ...]) -> list[str] | None:
    """Which columns are read; None means all."""
    about = file.metadata
    names = file.schema_arrow.names
    some = [
        n
        for n in dict.fromkeys(names)
        if any(w == n or w.startswith((f"{n}.", f"{n}[")) for w in wanted)
    ]
    return some if some and 8 * about.num_rows * about.num_columns > LIGHT else None


def _take(table: Table, name: str, column: "pa.ChunkedArray") -> None:
    import pyarrow as pa
    import pyarrow.compute as pc

    from spirob.logs.readers.columns import add, spread

    kind = column.type
    if pa.types.is_list(kind) or pa.types.is_large_list(kind) or pa.types.is_fixed_size_list(kind):
        sizes = pc.list_value_length(column).to_numpy()
        if len(sizes) < 2 or not np.all(sizes == sizes[0]) or sizes[0] < 1:
            table.text[name] = "lists of different lengths"
            return
        inner = pc.list_flatten(column)
        if pa.types.is_integer(inner.type) or pa.types.is_floating(inner.type):
            rows = inner.to_numpy().astype(float).reshape(len(sizes), -1)
            for k in range(rows.shape[1]):
                add(table, f"{name}[{k}]", rows[:, k])
            table.columns.update(spread(name, rows) if rows.shape[1] == 1 else ())
    elif pa.types.is_timestamp(kind) or pa.types.is_date(kind):
        add(table, name, column.to_numpy())
    elif pa.types.is_time(kind):
        counted = column.cast(pa.time64("ns")).cast(pa.int64()).cast(pa.duration("ns"))
        add(table, name, counted.to_numpy())
    elif pa.types.is_decimal(kind) or pa.types.is_boolean(kind):
        add(table, name, column.cast(pa.float64()).to_numpy())
    elif pa.types.is_integer(kind) or pa.types.is_floating(kind) or pa.types.is_duration(kind):
        add(table, name, column.to_numpy())
    else:
        add(table, name, np.array(column.to_pylist(), object))
