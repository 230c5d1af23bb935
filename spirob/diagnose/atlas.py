"""The residual atlas: which regimes hold the error.

Every sample of the residual is put into overlapping regimes (by speed, direction,
reversal, load, bend, time); each regime gets its share of the squared error beside its share of
the time, and its bias.
"""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from spirob.identify.problem import Effort, Problem, Stretch

REVERSAL = 0.1  # s, on either side of a change of direction


@dataclass(frozen=True)
class Regime:
    """One region of the data.

    share_of_error  of the summed squared residual;  share_of_time  of the samples
    bias, rmse      of the residual inside, in its unit
    """

    regime: str
    share_of_error: float
    share_of_time: float
    bias: float
    rmse: float

    def as_dict(self) -> dict[str, Any]:
        """Plain numbers."""
        return asdict(self)


def atlas(residual: Problem, values: np.ndarray) -> list[Regime]:
    """Regimes of a residual (as `residual` returned it), the largest share of error first."""
    pieces = residual.stretches()
    masks: dict[str, list[np.ndarray]] = {}
    for k, piece in enumerate(pieces):
        for name, mask in masks_of(piece).items():
            # a regime that another stretch does not know holds nothing of that stretch
            parts = masks.setdefault(name, [np.zeros(len(p.velocity), bool) for p in pieces])
            parts[k] = mask
    total = float(np.sum(values**2)) or 1.0
    regimes = []
    for name, parts in masks.items():
        inside = values[np.concatenate(parts)]
        if len(inside) == 0:
            continue
        share = float(np.sum(inside**2)) / total
        rmse = float(np.sqrt(np.mean(inside**2)))
        regimes.append(Regime(name, share, len(inside) / len(values), float(np.mean(inside)), rmse))
    return sorted(regimes, key=lambda r: -r.share_of_error)


def masks_of(piece: Stretch) -> dict[str, np.ndarray]:
    """Which samples of a stretch belong to each regime."""
    velocity, load = piece.velocity, piece.effort
    speed, bend = np.abs(velocity), np.abs(piece.position)
    turns = piece.seconds[:-1][np.diff(np.sign(velocity)) != 0]
    near = np.searchsorted(turns, piece.seconds + REVERSAL, "right") > np.searchsorted(
        turns, piece.seconds - REVERSAL
    )
    middle = piece.seconds[0] + 0.5 * (piece.seconds[-1] - piece.seconds[0])
    masks = {
        piece.forward: velocity > piece.still,
        piece.backward: velocity < -piece.still,
        "standing": speed <= piece.still,
        "fastest third": speed >= np.quantile(speed, 0.67),
        "0.1 s around reversals": near,
        "high load": load >= np.quantile(load, 0.67),
        "low load": load <= np.quantile(load, 0.33),
        "furthest third of the way": bend >= np.quantile(bend, 0.67),
        "nearest third of the way": bend <= np.quantile(bend, 0.33),
        "second half of the trial": piece.seconds >= middle,
    }
    if piece.channel:
        masks[f"{piece.channel} driven"] = np.ones(len(velocity), dtype=bool)
    return masks


def worst(regimes: Sequence[Regime], effort: Effort, count: int = 3) -> list[str]:
    """The regimes that hold more error than their time explains, a sentence each."""
    dense = sorted(regimes, key=lambda r: -(r.share_of_error - r.share_of_time))[:count]
    return [
        f"{r.share_of_error:.0%} of the error in {r.share_of_time:.0%} of the time: {r.regime} "
        f"(model minus measurement {effort.shown(r.bias)} on average)."
        for r in dense
        if r.share_of_error > r.share_of_time
    ]
