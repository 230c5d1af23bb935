"""What any combination of candidate effects leaves, ready before somebody asks for it.

Every combination of the first five candidates was played on the validation and held-out trials
before: one alone with all numbers refitted, several with numbers to first order from those (see
`pipeline/switches.py`).  The combination that the verdict names is its own model, fitted to the
end.  Held-out trials are only scored.
"""

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations as subsets

import numpy as np
import pandas as pd

from spirob.report.data import ReportData
from spirob.report.regimes import masks

JOINT = " + "  # between the names of a combination
KEYS = ["trial", "motor", "time"]
CHANNELS = ("current", "displacement", "velocity")
HOW = {
    "base": "full simulation, fitted numbers only",
    "verdict": "full simulation, the verdict's model, fitted to the end",
    "refitted": "full simulation, everything refitted",
    "screened": "full simulation, numbers as the screening left them",
    "replayed": "in replay: numbers to first order, the trials played again with them",
}


@dataclass(frozen=True)
class Combination:
    """Some of the effects, and what is left of the current [A].

    how      key of `HOW`
    rmse     by role;  regimes  by regime, over all trials of these roles
    """

    effects: tuple[str, ...]
    how: str
    rmse: dict[str, float]
    regimes: dict[str, float]

    @property
    def column(self) -> str:
        """What its columns in the wide table begin with."""
        return {"base": "base", "verdict": "named"}.get(self.how, key(self.effects))


def key(effects: Sequence[str]) -> str:
    """Name of a combination, whatever the order of its effects."""
    return JOINT.join(sorted(effects))


def switchable(data: ReportData) -> tuple[pd.DataFrame, list[str]]:
    """The overlay with what each combination makes of it, and the effects, most probable first."""
    if data.combinations is None:
        return data.overlay, []
    there = {key(str(name).split(JOINT)) for name in data.combinations["effects"].unique()}
    alone = [name for name in there if JOINT not in name]
    chances = {c["name"]: c.get("probability") or 0.0 for c in data.diagnosis["candidates"]}
    # those that were only screened have no probability and come last
    ranked = sorted(sorted(alone), key=lambda name: -chances.get(name, -1.0))
    return widened(data.overlay, data.combinations), ranked


def widened(overlay: pd.DataFrame, played: pd.DataFrame) -> pd.DataFrame:
    """The overlay with columns COMBINATION_CHANNEL at the same samples; `how` in its attributes."""
    wide, how = overlay, {}
    for label, rows in played.groupby("effects", sort=False, observed=True):
        name = key(str(label).split(JOINT))
        how[name] = str(rows["how"].iloc[0])
        columns = {channel: f"{name}_{channel}" for channel in CHANNELS}
        rows = rows[[*KEYS, *columns]].rename(columns=columns).astype({"trial": str, "motor": str})
        wide = wide.merge(rows, on=KEYS, how="left")
    wide.attrs["how"] = how
    return wide


def played(wide: pd.DataFrame) -> list[str]:
    """Names of the combinations whose signals the wide table holds."""
    return list(wide.attrs.get("how", ()))


def combinations(
    wide: pd.DataFrame,
    effects: Sequence[str],
    driven: Collection[tuple[str, str]],
    verdict: Collection[str] = (),
) -> list[Combination]:
    """All combinations that were played, fewer effects first, none before all.

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
    roles, measured = table["role"].to_numpy(str), table["measured_current"].to_numpy(float)
    inside = _regimes(pieces)
    found = []
    for chosen, how, column in _played(wide.attrs["how"], effects, verdict):
        left = table[f"{column}_current"].to_numpy(float) - measured
        rmse = {str(role): _rms(left[roles == role]) for role in np.unique(roles)}
        by_regime = {name: _rms(left[mask]) for name, mask in inside.items() if mask.any()}
        found.append(Combination(chosen, how, rmse, by_regime))
    return found


def _played(
    how: dict[str, str], effects: Sequence[str], verdict: Collection[str]
) -> Iterator[tuple[tuple[str, ...], str, str]]:
    """Effects, origin and column of every combination."""
    for count in range(len(effects) + 1):
        for chosen in subsets(effects, count):
            if not chosen:
                yield chosen, "base", "base"
            elif set(chosen) == set(verdict):
                yield chosen, "verdict", "named"
            elif key(chosen) in how:
                yield chosen, how[key(chosen)], key(chosen)


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
