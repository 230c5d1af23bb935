"""A log as columns of numbers: CSV, Parquet, or one of our own MCAP logs."""

from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from spirob.errors import DataError, MissingLog
from spirob.logs import read_log
from spirob.machine.csv_table import read_csv

TEXT = {".csv", ".txt", ".tsv", ".dat"}


def read_columns(path: Path | str) -> tuple[dict[str, np.ndarray], list[str]]:
    """All numeric columns of a log by name, and sentences about what was not plain.

    An MCAP log gives its decoded channels (`left.current` ...) and `time` in seconds.
    Raises MissingLog where there is no file, DataError where it cannot be read.
    """
    path = Path(path)
    if not path.is_file():
        raise MissingLog(f"{path}: there is no such log")
    if path.suffix.lower() in TEXT:
        return read_csv(path)
    if path.suffix.lower() == ".parquet":
        return _read_parquet(path), []
    if path.suffix.lower() == ".mcap":
        trace = read_log(path)
        return {"time": trace.seconds, **trace.signals}, []
    raise DataError(f"{path}: '{path.suffix}' is no known kind of log; known: .csv .parquet .mcap")


def _read_parquet(path: Path) -> dict[str, np.ndarray]:
    try:
        table = pq.read_table(path)
        columns = {}
        for name in table.column_names:
            kind = table.schema.field(name).type
            if pa.types.is_temporal(kind):
                values = table[name].cast(pa.timestamp("ns")).cast(pa.int64())
                columns[name] = values.to_numpy().astype(float)
            elif pa.types.is_integer(kind) or pa.types.is_floating(kind):
                columns[name] = table[name].to_numpy().astype(float)
    except (pa.ArrowException, OSError, ValueError, TypeError) as error:
        said = str(error).partition("\n")[0]
        raise DataError(f"{path}: this is no readable Parquet file: {said}") from error
    return columns
