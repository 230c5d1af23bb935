"""Bring a measurement from elsewhere into a trace in SI units, by a mapping file.

Reads CSV, Parquet, MATLAB files of version 5 and MCAP (JSON or protobuf); writes Parquet that every
other command takes.  What had to be repaired is said, and kept with the trace.
"""

import argparse
import sys
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path

    import numpy as np

    from spirob.logs.foreign import Mapping

HELP = "import CSV, Parquet, .mat or MCAP from elsewhere with a mapping file"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of `spirob import`."""
    parser.add_argument("file", metavar="FILE", help="a .csv, .parquet, .mat or .mcap file")
    parser.add_argument(
        "--map", required=True, metavar="MAP.yaml", help="what is what, in what unit"
    )
    parser.add_argument("--out", required=True, metavar="TRACE.parquet", help="file to write")


def run(arguments: argparse.Namespace) -> int:
    """Import and say what came of it."""
    from pathlib import Path

    from spirob.errors import DataError
    from spirob.logs.foreign import read_mapping, trace_from
    from spirob.logs.parquet import write_parquet

    source, out = Path(arguments.file), Path(arguments.out)
    if out.suffix != ".parquet":
        raise DataError(f"{out}: a trace is kept as .parquet")
    if out.exists():
        raise DataError(f"{out}: exists already and is left as it is")
    mapping = read_mapping(arguments.map)
    notes: list[str] = []
    trace = trace_from(source.name, _columns(source, mapping, notes), mapping, notes)
    write_parquet(trace, out)
    for note in notes:
        print(f"note: {note}", file=sys.stderr)
    print(f"{out}: {len(trace)} rows of {', '.join(trace.signals)}")
    return 0


def _columns(source: "Path", mapping: "Mapping", notes: list[str]) -> "dict[str, np.ndarray]":
    from spirob.logs.bounds import check_size
    from spirob.logs.foreign.mat import read_mat
    from spirob.logs.foreign.mcap_fields import read_fields
    from spirob.logs.foreign.parquet import read_parquet_columns
    from spirob.machine.reading import read_columns

    if source.suffix.lower() == ".mat":
        return read_mat(source)
    if source.suffix.lower() == ".mcap":
        return read_fields(source, mapping, notes)
    if source.suffix.lower() == ".parquet":
        return read_parquet_columns(source)
    check_size(source)
    columns, said = read_columns(source)
    notes += said
    return columns
