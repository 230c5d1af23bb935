"""Do the logs differ by a number of their own: another force, payload or zero in each?

Such a number of every log has to pass what an effect has to pass; of several that do, the one that
fits the held-out logs best is taken.
"""

from collections.abc import Mapping
from itertools import pairwise

import numpy as np

from spirob.diagnosis.model import Model
from spirob.machine.laws import LEVER
from spirob.machine.models import RigSearch
from spirob.machine.preparation import Ready, search_of
from spirob.machine.rig import RigFile

KINDS = ("offset", "payload", "zero")  # of numbers that logs may have each for itself
FIRST = {"payload": 1.0, "zero": 0.0}  # of the first log, where the others count from it


def differing(ready: Ready, search: RigSearch, chosen: Model) -> tuple[Ready, str] | None:
    """The rig whose logs differ by the kind of number that fits best, and what is said of it."""
    told = {k: ready.told(per_log=(k,)) for k in KINDS if may_differ(k, ready.rig, search, chosen)}
    made = {kind: _fitted(one, chosen, kind) for kind, one in told.items()}
    alone = not {r.log for r in ready.test} <= {r.log for r in ready.train}
    fits = {
        kind: model
        for kind, model in made.items()
        if search.worth.matters(chosen, model) and tells(kind, model, alone)
    }
    if not fits:
        return None
    best = min(fits, key=lambda kind: fits[kind].heldout_square)
    return told[best], _said(best, fits, search.models.size)


def _fitted(told: Ready, chosen: Model, kind: str) -> Model:
    """The chosen effects with a number of each log; a zero shows by what depends on the place."""
    search, _ = search_of(told)
    weight = [e for e in search.candidates if e in LEVER.values() and e not in chosen.effects]
    effects = (*chosen.effects, *weight) if kind == "zero" else chosen.effects
    return search.models.fitted(effects, chosen.fit.changes)


def tells(kind: str, model: Model, alone: bool = False) -> bool:
    """Whether the numbers of two logs of a model lie apart, each within its interval.

    A payload that is counted in that of the first log has to do something, too.

    alone  whether a held-out log has a number for itself, which no interval is known of: the logs
           may differ by that
    """
    found = model.fit.estimates
    ends = [(e.low, e.high) for name, e in found.items() if name.startswith(f"{kind}.")]
    made = [e for name, e in found.items() if name.startswith("rig.payload_")]
    if kind == "payload" and made and all(e.low <= 0.0 <= e.high for e in made):
        return False
    if kind == "zero" or (kind == "payload" and made):
        ends.append((FIRST[kind], FIRST[kind]))
    return alone or max(low for low, _ in ends) > min(high for _, high in ends)


def _said(best: str, fits: Mapping[str, Model], size: float) -> str:
    """By which kind the logs differ, and the held-out error with each that explains more.

    size  RMS effort
    """
    left = {kind: f"{np.sqrt(m.heldout_square) / size:.2%}" for kind, m in fits.items()}
    others = "".join(f", with {kind} {left[kind]}" for kind in fits if kind != best)
    return (
        f"The logs differ by a number of their own, {best}: fitted for each. With it the held-out "
        f"logs leave {left[best]} of the effort{others}."
    )


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
        return None if kind == "zero" else np.column_stack([signals["acceleration"], ones])
    turned = signals["position"]
    weight = [np.sin(turned), np.cos(turned)]
    return np.column_stack(weight if kind == "zero" else [signals["acceleration"], *weight])


def _left(columns: np.ndarray, residual: np.ndarray) -> float:
    found = np.linalg.lstsq(columns, residual, rcond=None)[0]
    return float(np.sum((residual - columns @ found) ** 2))
