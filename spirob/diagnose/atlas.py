"""The residual atlas: which regimes hold the error.

Every sample of the driven motors' residual is put into overlapping regimes (by speed, direction,
reversal, load, bend, time); each regime gets its share of the squared error beside its share of
the time, and its bias.
"""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from spirob.identify.residual import Residual

REVERSAL = 0.1  # s, on either side of a change of direction
STILL = 1e-3  # m/s, slower is standing


@dataclass(frozen=True)
class Regime:
    """One region of the data.

    share_of_error  of the summed squared residual;  share_of_time  of the samples
    bias, rmse      of the residual inside [A]
    """

    regime: str
    share_of_error: float
    share_of_time: float
    bias: float
    rmse: float

    def as_dict(self) -> dict[str, Any]:
        """Plain numbers."""
        return asdict(self)


def atlas(residual: Residual, values: np.ndarray) -> list[Regime]:
    """Regimes of a residual (in the order of `Residual`), the largest share of error first."""
    masks: dict[str, list[np.ndarray]] = {}
    for trial in residual.trials:
        for motor in residual.driven(trial):
            thin = residual.filter.thin
            velocity = thin(trial.velocity[:, motor], trial.name)
            moved = thin(trial.displacement[:, motor], trial.name)
            load = thin(trial.current[:, motor], trial.name)
            step = residual.filter.every * 1e-3
            for name, mask in _masks(velocity, moved, load, motor, step).items():
                masks.setdefault(name, []).append(mask)
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


def _masks(
    velocity: np.ndarray, moved: np.ndarray, load: np.ndarray, motor: int, step: float
) -> dict[str, np.ndarray]:
    speed = np.abs(velocity)
    fast = np.quantile(speed, 0.67)
    turn = np.flatnonzero(np.diff(np.sign(velocity)) != 0)
    near = np.zeros(len(velocity), dtype=bool)
    reach = round(REVERSAL / step)
    for k in turn:
        near[max(0, k - reach) : k + reach + 1] = True
    bend = np.abs(moved)
    late = np.arange(len(velocity)) >= len(velocity) // 2
    return {
        "winding in": velocity > STILL,
        "paying out": velocity < -STILL,
        "standing": speed <= STILL,
        "fastest third": speed >= fast,
        "0.1 s around reversals": near,
        "high load": load >= np.quantile(load, 0.67),
        "low load": load <= np.quantile(load, 0.33),
        "most bent third": bend >= np.quantile(bend, 0.67),
        "least bent third": bend <= np.quantile(bend, 0.33),
        "second half of the trial": late,
        "left motor driven": np.full(len(velocity), motor == 0),
        "right motor driven": np.full(len(velocity), motor == 1),
    }


def worst(regimes: Sequence[Regime], count: int = 3) -> list[str]:
    """The regimes that hold more error than their time explains, a sentence each."""
    dense = sorted(regimes, key=lambda r: -(r.share_of_error - r.share_of_time))[:count]
    return [
        f"{r.share_of_error:.0%} of the error in {r.share_of_time:.0%} of the time: {r.regime} "
        f"(model minus robot {r.bias:+.3f} A on average)."
        for r in dense
        if r.share_of_error > r.share_of_time
    ]
