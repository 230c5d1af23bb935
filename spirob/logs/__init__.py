"""Logs of trials: MCAP as recorded, `Trace` as used, Parquet in between.

`TrialLog` writes, `read_log` reads; `write_parquet` and `read_parquet` keep a decoded trace.
Raw CAN frames are the truth of a log; everything in SI units is derived from them.
"""

from spirob.logs.cycles import Transmission
from spirob.logs.parquet import read_parquet, write_parquet
from spirob.logs.reader import read_log
from spirob.logs.writer import TrialLog

__all__ = [
    "Transmission",
    "TrialLog",
    "read_log",
    "read_parquet",
    "write_parquet",
]
