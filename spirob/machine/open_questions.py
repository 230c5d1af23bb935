"""What a description leaves open: numbers of single logs, and where the position sensor sits.

What is left of the chosen model may be another force, or another payload, in each log.  Such a
number of every log has to pass what an effect has to pass.

A sensor at the motor and one at the load, behind an elastic gear or one with play, see different
motions.  What is left of the model chosen for the one may be what the laws of the other take.
"""

from itertools import pairwise

import numpy as np

from spirob.diagnosis.model import Model
from spirob.machine.laws import LOAD_SIDE
from spirob.machine.models import RigSearch
from spirob.machine.rig import RigFile

KINDS = ("offset", "payload")


def may_differ(kind: str, rig: RigFile, search: RigSearch, chosen: Model) -> bool:
    """Whether a kind of number may differ between the training logs, by what is left of a model.

    It may where its columns, one set for each log, take more of the squared residual than the least
    share of an effect beyond what the same columns take for all logs together.
    """
    logs = {r.log for r in search.models.train.recordings}
    if rig.per_log is not None or rig.logs or len(logs) < 2:
        return False
    columns = _columns(kind, rig, search)
    if columns is None:
        return False
    residual, edges = chosen.fit.residual, search.models.train.edges
    together = _left(columns, residual)
    apart = sum(_left(columns[a:b], residual[a:b]) for a, b in pairwise(edges))
    return together - apart > search.criteria.share * float(np.dot(residual, residual))


def _columns(kind: str, rig: RigFile, search: RigSearch) -> np.ndarray | None:
    """What a number of this kind does to the effort, to first order, (N, k); None where nothing."""
    signals = search.models.train.signals()
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


AT_LOAD = (
    "The logs fit a position sensor at the load, behind gear and shaft, better than one at the "
    "motor: taken so. position.side says where it sits."
)


def may_sit_at_load(rig: RigFile, search: RigSearch, chosen: Model) -> bool:
    """Whether a description leaves the side open and enough is left for it to matter."""
    opened = rig.position is not None and rig.position.side is None and isinstance(rig.body, str)
    return opened and search.worth.possible(chosen, 0.0, search.models.promised)


def fits_at_load(at_load: RigSearch, chosen: Model) -> bool:
    """Whether a law of the load's side halves what the model chosen for the motor's leaves.

    at_load  the search in which the sensor sits there

    Less would be too little to contradict what most descriptions mean: the edges of friction at a
    reversal look like a little play behind the sensor.
    """
    kept = tuple(e for e in chosen.effects if e.name() not in LOAD_SIDE)
    laws = [e for e in at_load.candidates if e in LOAD_SIDE.values()]
    grown = at_load.extended(kept, chosen.fit.changes, laws)
    return any(at_load.worth.halves(chosen, model) for model in grown)
