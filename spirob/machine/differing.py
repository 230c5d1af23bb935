"""Do the logs differ by numbers of their own?  Asked where a description leaves it open.

What is left of the chosen model may be another force, or another payload, in each log.  Such a
number of every log has to pass what an effect has to pass.
"""

from itertools import pairwise

import numpy as np

from spirob.machine.models import Model
from spirob.machine.rig import RigFile
from spirob.machine.search import Search

KINDS = ("offset", "payload")


def may_differ(kind: str, rig: RigFile, search: Search, chosen: Model) -> bool:
    """Whether a kind of number may differ between the training logs, by what is left of a model.

    It may where its columns, one set for each log, take more of the squared residual than the least
    share of an effect beyond what the same columns take for all logs together.
    """
    logs = {r.log for r in search.train.recordings}
    if rig.per_log is not None or rig.logs or len(logs) < 2:
        return False
    columns = _columns(kind, rig, search)
    if columns is None:
        return False
    residual, edges = chosen.fit.residual, search.train.edges
    together = _left(columns, residual)
    apart = sum(_left(columns[a:b], residual[a:b]) for a, b in pairwise(edges))
    return together - apart > search.settings.share * float(np.dot(residual, residual))


def _columns(kind: str, rig: RigFile, search: Search) -> np.ndarray | None:
    """What a number of this kind does to the effort, to first order, (N, k); None where nothing."""
    signals = search.train.signals()
    ones = np.ones_like(signals["speed"])
    if kind == "offset":
        return ones[:, None]
    if not isinstance(rig.body, str) or rig.position is None:
        return None  # a body's payload hangs at its tip, which its model may not have
    if not rig.angular:
        return np.column_stack([signals["acceleration"], ones])
    turned = signals["position"]
    return np.column_stack([signals["acceleration"], np.sin(turned), np.cos(turned)])


def _left(columns: np.ndarray, residual: np.ndarray) -> float:
    found = np.linalg.lstsq(columns, residual, rcond=None)[0]
    return float(np.sum((residual - columns @ found) ** 2))
