"""How the loop kept its deadlines in each recorded trial, from what the logs say of it."""

import json
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

from spirob.logs.parquet import KEY
from spirob.logs.schema import LOOP

FIGURES = ("cycles", "skipped", "lateness_p50_us", "lateness_p99_us", "lateness_max_us")


def read_loops(folder: Path) -> dict[str, dict[str, Any]]:
    """Trial -> figures [µs], `histogram` with its edges, and `priority`; none in simulated time.

    folder  of decoded traces; of each, only the description is read
    """
    found = {}
    for path in sorted(folder.glob("*.parquet")):
        try:
            meta = json.loads((pq.read_schema(path).metadata or {})[KEY])["meta"]
            found[path.stem] = _numbers(meta[LOOP])
        except (KeyError, ValueError, TypeError, OSError, pa.ArrowException):
            continue  # no trace of a robot in real time
    return found


def _numbers(loop: dict[str, str]) -> dict[str, Any]:
    figures = {name: float(loop[name]) for name in FIGURES}
    edges = [float(edge) for edge in loop["histogram_from_us"].split()]
    counts = [int(count) for count in loop["histogram"].split()]
    if len(edges) != len(counts):
        raise ValueError("a histogram needs as many edges as counts")
    return {**figures, "edges": edges, "counts": counts, "priority": str(loop["priority"])}
