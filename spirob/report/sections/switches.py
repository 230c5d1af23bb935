"""Watch the error fall by hand: candidate effects as switches."""

from collections.abc import Mapping, Sequence
from typing import Any

from spirob.effects import all_effects
from spirob.report import regimes
from spirob.report.combinations import HOW, Combination, combinations, switchable
from spirob.report.data import ReportData
from spirob.report.figures import Plot
from spirob.report.regimes import driven
from spirob.report.sections import Section
from spirob.report.words import column

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
        regimes.regimes(errors, "current", "mA"),
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
        figure = regimes.regimes(found[0].regimes, effort, unit)
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
