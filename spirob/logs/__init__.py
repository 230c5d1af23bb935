"""Logs of trials: MCAP as recorded, `Trace` as used, Parquet in between.

`TrialLog` writes, `read_log` reads; `write_parquet` and `read_parquet` keep a decoded trace.
Raw CAN frames are the truth of a log; everything in SI units is derived from them.

    messages.py   topics, types of messages, their bytes
    writer.py     one trial, one MCAP file, readable whatever happens
    reader.py     an MCAP log as a `Trace`;  payloads.py  its payloads in bulk
    cycles.py     its frames sorted into cycles, and in SI units
    recovery.py   what a torn or damaged MCAP file still holds
    trace.py      signals on a time base, and as one Parquet file
Of others:
    readers/      logs of any kind as tables, one file for each kind
    foreign.py    such a table as a `Trace`, by a mapping file
    stamps.py     its stamps in their order, and an even clock behind coarse or late ones
"""

from spirob.logs.cycles import Transmission
from spirob.logs.reader import read_log
from spirob.logs.trace import read_parquet, write_parquet
from spirob.logs.writer import TrialLog

__all__ = [
    "Transmission",
    "TrialLog",
    "read_log",
    "read_parquet",
    "write_parquet",
]
