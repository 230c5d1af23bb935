"""What any combination of candidate effects would leave, ready before somebody asks for it.

Each candidate was added alone to the base model, everything refitted, in full simulation: what it
changes in a signal is g_e = model with e − base model.  Several at once are taken to first order,

    model(S) = base + Σ w_e·g_e,     0 ≤ w_e ≤ 1,

with the weights that fit the validation trials best; w = 1 for one alone, which is then the full
simulation again.  The combination that the verdict names is its own model, fitted to the end.
Held-out trials are only scored.
"""

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from itertools import combinations as subsets

import numpy as np
import pandas as pd
from scipy.optimize import lsq_linear

from spirob.report.data import ReportData
from spirob.report.regimes import masks

MOST = 5  # effects to switch: 32 combinations
KEYS = ["trial", "motor", "time"]


@dataclass(frozen=True)
class Combination:
    """Some of the effects, and what is left of the current [A].

    weights  of their changes; None for the model of the verdict, which is no sum
    rmse     by role;  regimes  by regime, over all trials of these roles
    """

    effects: tuple[str, ...]
    weights: dict[str, float] | None
    rmse: dict[str, float]
    regimes: dict[str, float]

    @property
    def full(self) -> bool:
        """Whether it is a full simulation rather than a first-order sum."""
        return self.weights is None or len(self.effects) < 2


def switchable(data: ReportData) -> tuple[pd.DataFrame, list[str]]:
    """The overlay with what each candidate makes of it, and their names, most probable first."""
    if data.finalists is None:
        return data.overlay, []
    there = set(data.finalists["effect"].unique())
    ranked = sorted(data.diagnosis["candidates"], key=lambda c: -(c.get("probability") or 0))
    names = [c["name"] for c in ranked if c["name"] in there][:MOST]
    kept = data.finalists[data.finalists["effect"].isin(names)]
    return widened(data.overlay, kept), names


def widened(overlay: pd.DataFrame, finalists: pd.DataFrame) -> pd.DataFrame:
    """The overlay with columns EFFECT_CHANNEL for each candidate, at the same samples."""
    wide = overlay
    for name, rows in finalists.groupby("effect", sort=False):
        columns = {c: f"{name}_{c}" for c in ("current", "displacement", "velocity")}
        wide = wide.merge(rows[[*KEYS, *columns]].rename(columns=columns), on=KEYS, how="left")
    return wide


def combinations(
    wide: pd.DataFrame,
    effects: Sequence[str],
    driven: Collection[tuple[str, str]],
    verdict: Collection[str] = (),
) -> list[Combination]:
    """All combinations of the first `MOST` effects, fewer effects first, none before all.

    wide     as `widened` returned it;  driven  trial and motor wherever the current is compared
    verdict  effects that the overlay's model `named` holds
    """
    pieces = [
        rows.sort_values("time")
        for (trial, motor), rows in wide.groupby(["trial", "motor"], sort=False)
        if (str(trial), str(motor)) in driven
    ]
    if not pieces:
        return []
    table = pd.concat(pieces)
    off = {
        origin: (table[f"{origin}_current"] - table["measured_current"]).to_numpy(float)
        for origin in ("base", "named", *effects[:MOST])
    }
    roles = table["role"].to_numpy(str)
    validate = roles == "validate"
    inside = _regimes(pieces)
    found = []
    for count in range(len(effects[:MOST]) + 1):
        for chosen in subsets(effects[:MOST], count):
            columns = np.array([off[e] - off["base"] for e in chosen]).reshape(count, len(roles))
            weights: dict[str, float] | None = None
            left = off["named"]
            if not chosen or set(chosen) != set(verdict):
                shares = _weights(columns[:, validate], off["base"][validate])
                weights = dict(zip(chosen, shares.tolist(), strict=True))
                left = off["base"] + shares @ columns
            rmse = {str(role): _rms(left[roles == role]) for role in np.unique(roles)}
            by_regime = {name: _rms(left[mask]) for name, mask in inside.items() if mask.any()}
            found.append(Combination(chosen, weights, rmse, by_regime))
    return found


def _weights(columns: np.ndarray, base: np.ndarray) -> np.ndarray:
    """Share of each change, between none and all; one alone is taken whole."""
    if len(columns) < 2 or not len(base):
        return np.ones(len(columns))
    return np.asarray(lsq_linear(columns.T, -base, (0.0, 1.0)).x)


def _regimes(pieces: Sequence[pd.DataFrame]) -> dict[str, np.ndarray]:
    """Which samples of all pieces, one after the other, belong to each regime."""
    each = [masks(rows, str(rows["trial"].iloc[0]), str(rows["motor"].iloc[0])) for rows in pieces]
    empty = [np.zeros(len(rows), bool) for rows in pieces]
    names = dict.fromkeys(name for found in each for name in found)
    return {
        name: np.concatenate([e.get(name, z) for e, z in zip(each, empty, strict=True)])
        for name in names
    }


def _rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(values**2)))
