"""Measurements from elsewhere, brought into a `Trace` by a mapping file.

mapping.py  what the mapping file may hold; units that cannot be right
trace.py    stamps that do not increase: repaired only where that is certain, and said; a table, as
            `spirob.logs.readers` reads it, and a mapping to a trace
"""

from spirob.logs.foreign.mapping import Mapping, read_mapping
from spirob.logs.foreign.trace import trace_from

__all__ = ["Mapping", "read_mapping", "trace_from"]
