"""The residual atlas: which regimes hold the error.

Every sample of the residual is put into overlapping regimes (`regimes`), and, of several trials,
into its own; each regime gets its share of the squared error beside its share of the time, and its
bias.
"""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from spirob.diagnosis.regimes import Masks, kinds_of
from spirob.identify.problem import Effort, Problem

WHOLE = 0.8  # of the time: a regime that takes more is no place of its own
ALONE = ("temperature", "trial", "slack", "contact")  # one regime in all of the time tells nothing
# kinds that say much the same: of these one sentence is enough
FAMILIES = {"trial": "motor", "loading": "load"}


@dataclass(frozen=True)
class Regime:
    """One region of the data.

    share_of_error  of the summed squared residual;  share_of_time  of the samples
    bias, rmse      of the residual inside, in its unit
    kind            what it is about: regimes of one kind are compared with one another
    """

    regime: str
    share_of_error: float
    share_of_time: float
    bias: float
    rmse: float
    kind: str = ""

    def as_dict(self) -> dict[str, Any]:
        """Plain numbers."""
        return asdict(self)


def atlas(
    residual: Problem, values: np.ndarray, more: Sequence[dict[str, Masks]] = ()
) -> list[Regime]:
    """Regimes of a residual (as `residual` returned it), the largest share of error first.

    more  of each stretch: kind -> masks that do not follow from its own signals
    """
    pieces = residual.stretches()
    known = [kinds_of(p) | {"trial": {p.trial: np.ones(len(p.seconds), bool)}} for p in pieces]
    for k, further in enumerate(more):
        known[k] |= further
    total = float(np.sum(values**2)) or 1.0
    regimes = []
    names = dict.fromkeys((kind, n) for found in known for kind in found for n in found[kind])
    for kind, name in names:
        # a regime that another stretch does not know holds nothing of that stretch
        parts = [
            found.get(kind, {}).get(name, np.zeros(len(p.velocity), bool))
            for found, p in zip(known, pieces, strict=True)
        ]
        inside = values[np.concatenate(parts)]
        if len(inside) == 0 or (kind in ALONE and len(inside) == len(values)):
            continue
        share = float(np.sum(inside**2)) / total
        rmse = float(np.sqrt(np.mean(inside**2)))
        time = len(inside) / len(values)
        regimes.append(Regime(name, share, time, float(np.mean(inside)), rmse, kind))
    return sorted(regimes, key=lambda r: -r.share_of_error)


def worst(regimes: Sequence[Regime], effort: Effort, count: int = 3) -> list[str]:
    """The regimes that hold more error than their time explains, a sentence each.

    Of the regimes of one kind, which overlap or follow from one another, the worst alone.
    """
    dense: dict[str, Regime] = {}
    for regime in sorted(regimes, key=lambda r: r.share_of_time - r.share_of_error):
        if regime.share_of_error > regime.share_of_time and regime.share_of_time <= WHOLE:
            dense.setdefault(FAMILIES.get(regime.kind, regime.kind) or regime.regime, regime)
    return [
        f"{r.share_of_error:.0%} of the error in {r.share_of_time:.0%} of the time: {r.regime} "
        f"(model minus measurement {effort.shown(r.bias)} on average)."
        for r in list(dense.values())[:count]
    ]
