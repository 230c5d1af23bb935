"""Bring a measurement from elsewhere into a trace in SI units, by a mapping file.

Reads whatever `spirob diagnose` reads, and writes Parquet that every other command takes.  What had
to be repaired is said, and kept with the trace.
"""

import argparse
import sys
from pathlib import Path

from spirob.errors import DataError

HELP = "import a log from elsewhere with a mapping file"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "file",
        metavar="FILE",
        help="CSV, Parquet, .mat, .h5, .npz, .json, a CAN log, MCAP, or a bag of ROS",
    )
    parser.add_argument(
        "--map", required=True, metavar="MAP.yaml", help="what is what, in what unit"
    )
    parser.add_argument("--dbc", metavar="FILE", help="what the frames of a CAN log mean")
    parser.add_argument("--out", required=True, metavar="TRACE.parquet", help="file to write")


def run(arguments: argparse.Namespace) -> int:
    """Import and say what came of it."""
    from spirob.logs.foreign import read_mapping, trace_from
    from spirob.logs.readers import read_table
    from spirob.logs.readers.columns import printable
    from spirob.logs.trace import write_parquet

    out = Path(arguments.out)
    if out.suffix != ".parquet":
        raise DataError(f"{out}: a trace is kept as .parquet")
    if out.exists():
        raise DataError(f"{out}: exists already and is left as it is")
    mapping = read_mapping(arguments.map)
    table = read_table(arguments.file, mapping.columns, arguments.dbc)
    trace = trace_from(table, mapping)
    write_parquet(trace, out)
    for note in table.said:
        print(f"note: {note}", file=sys.stderr)
    print(printable(f"{out}: {len(trace)} rows of {', '.join(trace.signals)}"))
    return 0
