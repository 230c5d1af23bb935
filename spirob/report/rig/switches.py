"""Candidate effects of a rig as switches: what each combination leaves of the error."""

from typing import Any

from spirob.report.combinations import Combination
from spirob.report.data import ReportData
from spirob.report.figures import Plot
from spirob.report.regimes import regimes
from spirob.report.sections import Section
from spirob.report.sections.switches import entry, names, rows

ABSENT = "No effect was fitted beside the numbers that the description asks for."
HOW = {
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
        figure = regimes(found[0].regimes, effort, unit)
        return {
            "switches": [{"name": n, "title": titles[n], "on": n in on} for n in effects],
            "combinations": [entry(one, how=HOW) for one in found],
            "rows": rows(found, ("train", "heldout"), how=HOW),
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
