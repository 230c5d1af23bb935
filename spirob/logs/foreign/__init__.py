"""Measurements from elsewhere, brought into a `Trace` by a mapping file.

mapping.py    what the mapping file may hold
clock.py      stamps that do not increase: repaired only where that is certain, and said
agreement.py  units that cannot be right
mat.py        MATLAB files of version 5;  parquet.py  Parquet;  mcap_fields.py  MCAP of others
apart.py      native readers in a process of their own, with bounded memory
trace.py      columns and mapping to a trace
"""

from spirob.logs.foreign.mapping import Mapping, read_mapping
from spirob.logs.foreign.trace import trace_from

__all__ = ["Mapping", "read_mapping", "trace_from"]
