"""Watch the error fall by hand: candidate effects as switches.

What any combination of candidates leaves is ready before somebody asks for it.  Every combination
of the first five was played on the validation and held-out trials before: one alone with all
numbers refitted, several with numbers to first order from those (see `pipeline/overlay.py`).  The
combination that the verdict names is its own model, fitted to the end.  Held-out trials are only
scored.
"""

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations as subsets
from typing import Any

import numpy as np
import pandas as pd

from spirob.effects import all_effects
from spirob.identify.problem import rms
from spirob.report import figures
from spirob.report.data import ReportData
from spirob.report.figures import Plot, driven, masks
from spirob.report.sections import Section
from spirob.report.words import column

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
    for chosen, how, origin in _played(wide.attrs["how"], effects, verdict):
        left = table[f"{origin}_current"].to_numpy(float) - measured
        rmse = {str(role): rms(left[roles == role]) for role in np.unique(roles)}
        by_regime = {name: rms(left[mask]) for name, mask in inside.items() if mask.any()}
        found.append(Combination(chosen, how, rmse, by_regime))
    return found


def _played(
    how: dict[str, str], effects: Sequence[str], verdict: Collection[str]
) -> Iterator[tuple[tuple[str, ...], str, str]]:
    """Effects, how they were played, and what its columns begin with, of every combination."""
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


MILLI = 1e3  # the page shows mA


class Switches(Section):
    """Switching an effect on redraws error, regimes and the overlay; all is computed before."""

    order = 15
    title = "By hand"
    template = "switches.html.j2"

    def get_context(self, data: ReportData) -> dict[str, Any]:
        table, effects = switchable(data)
        on = {effect["name"] for effect in data.diagnosis["effects"]}
        found = combinations(table, effects, driven(data.compare), on) if effects else []
        titles = names(data, effects)
        return {
            "switches": [
                {"name": name, "title": titles[name], "on": name in on}
                for name in (effects if found else [])
            ],
            "combinations": [entry(one, MILLI) for one in found],
            "rows": rows(found, ("validate", "heldout"), MILLI),
            "roles": ("validate", "held-out"),
            "unit": "mA",
            "effort": "current",
            "over": "validation and held-out trials",
            "where": ", here and in the signals below",
            "plot": _plot(found[0]) if found else None,
            "reason": data.absent.get("combinations", "No candidate passed the screening."),
        }


def names(data: ReportData, effects: list[str]) -> dict[str, str]:
    """What a reader calls each effect: as the diagnosis does, else the library."""
    known = {name: effect.title for name, effect in all_effects().items()}
    known |= {c["name"]: c["title"] for c in data.diagnosis["candidates"]}
    return {name: known.get(name, name.replace("_", " ")) for name in effects}


def entry(one: Combination, factor: float = 1.0, how: Mapping[str, str] = HOW) -> dict[str, Any]:
    """What the page's script needs of a combination; errors in the unit shown, times `factor`."""
    return {
        "effects": list(one.effects),
        "column": one.column,
        "rmse": {role: float(f"{factor * value:.5g}") for role, value in one.rmse.items()},
        "regimes": {n: float(f"{factor * value:.5g}") for n, value in one.regimes.items()},
        "how": how[one.how],
    }


def rows(
    found: list[Combination],
    roles: Sequence[str],
    factor: float = 1.0,
    how: Mapping[str, str] = HOW,
) -> list[dict[str, Any]]:
    """The same for those who read tables: a line for each combination, by the effects' names."""
    errors = [
        column([factor * one.rmse[role] if role in one.rmse else None for one in found])
        for role in roles
    ]
    return [
        {
            "label": " + ".join(name.replace("_", " ") for name in one.effects) or "none",
            "how": how[one.how],
            "errors": [each[k] for each in errors],
        }
        for k, one in enumerate(found)
    ]


def _plot(base: Combination) -> Plot:
    errors = {name: MILLI * value for name, value in base.regimes.items()}
    return Plot(
        "regimes",
        "Error in each regime, base model and chosen effects",
        figures.regimes(errors, "current", "mA"),
    )


ABSENT = "No effect was fitted beside the numbers that the description asks for."
RIG_HOW = {
    "base": "the fitted numbers only",
    "verdict": "the model of the verdict",
    "refitted": "everything refitted",
}
KEPT = {"train": "train", "test": "heldout"}


class RigSwitches(Section):
    """The same switches as the arm's; nothing is drawn over the logs."""

    order = 18
    title = "By hand"
    template = "switches.html.j2"
    pages = ("rig",)

    @staticmethod
    def absent(context: dict[str, Any]) -> str:
        return "" if context["switches"] else ABSENT

    def get_context(self, data: ReportData) -> dict[str, Any]:
        diagnosis = data.diagnosis
        found = [_combination(one) for one in diagnosis.get("switches", ())]
        if len(found) < 2:
            return {"switches": []}
        effects = [one.effects[0] for one in found if len(one.effects) == 1]
        titles, on = names(data, effects), {effect["name"] for effect in diagnosis["effects"]}
        effort, unit = diagnosis["effort"], diagnosis["unit"]
        figure = figures.regimes(found[0].regimes, effort, unit)
        return {
            "switches": [{"name": n, "title": titles[n], "on": n in on} for n in effects],
            "combinations": [entry(one, how=RIG_HOW) for one in found],
            "rows": rows(found, ("train", "heldout"), how=RIG_HOW),
            "roles": ("fitted", "held-out"),
            "plot": Plot("regimes", "Error in each regime, fitted numbers and effects", figure),
            "unit": unit,
            "effort": effort,
            "over": "all logs",
            "where": "",
        }


def _combination(one: dict[str, Any]) -> Combination:
    rmse = {KEPT[role]: value for role, value in one["rmse"].items()}
    return Combination(tuple(one["effects"]), one["how"], rmse, one["regimes"])
