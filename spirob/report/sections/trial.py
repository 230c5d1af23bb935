"""How far the verdict can be trusted: the same diagnosis on many robots whose truth is known."""

from collections.abc import Mapping
from typing import Any

from spirob.report import trial_figures
from spirob.report.data import ReportData
from spirob.report.figures import Plot
from spirob.report.sections.section import Section
from spirob.report.words import fixed, is_number, percent

RATES = {
    "top1": "named, and the first name is right",
    "exact": "named, right, and nothing besides",
    "top3": "the right one among the first three fitted in full",
    "outside": "hidden, but showing too little there to be asked for",
    "undecided": "undecided between rivals",
    "called_unknown": "said to be none that the library holds",
    "wrong_and_confident": "wrongly named with 90 % or more",
    "false_alarm": "nothing hidden, yet something named",
    "unknown": "right answer not in the library: called unknown or undecided, as is right",
    "left_out": "the same, and no other named with confidence",
    "pairs_both": "two effects hidden, both named",
    "excess_error_closed": "share of the avoidable held-out error that naming took away",
}
FEW = 30  # robots, below which a rate says little


class Trial(Section):
    """Rates with their intervals, who is taken for whom, and whether the probabilities hold."""

    order = 45
    title = "Trial"
    template = "trial.html.j2"

    def get_context(self, data: ReportData) -> dict[str, Any]:
        found = data.trial or {}
        confusion = found.get("confusion") or {}
        return {
            "ran": data.trial is not None,
            "cases": found.get("cases"),
            "rates": rates(found),
            "plots": plots(found),
            "confusion": [
                {"hidden": spoken(kind), "said": said_of(said)} for kind, said in confusion.items()
            ],
            "reliable": bool(found.get("reliability")),
            "few": (found.get("cases") or FEW) < FEW,
            "reason": data.absent.get("trial", ""),
        }


def rates(found: Mapping[str, Any]) -> list[dict[str, str]]:
    """A row for each rate that was counted."""
    rows = []
    for key, meaning in RATES.items():
        one = found.get(key)
        if one and one.get("n") and is_number(one.get("value")):
            span = f"{percent(one['low'])} to {percent(one['high'])}"
            cells = {"value": percent(one["value"]), "interval": span}
            rows.append({"meaning": meaning, "n": fixed(one["n"], 0), **cells})
    return rows


def plots(found: Mapping[str, Any]) -> list[dict[str, Any]]:
    """The figures that the trial holds numbers for, each with its caption."""
    shown: list[dict[str, Any]] = []
    if found.get("reliability"):
        caption = "Does the probability hold? How often it was right, over how sure it was"
        figure = trial_figures.reliability(found["reliability"])
        plot = Plot("reliability", caption, figure)
        shown.append({"caption": caption, "plot": plot, "wide": False})
    if found.get("strength"):
        caption = "How strong must it be? Right names over the error that is left when it is known"
        figure = trial_figures.strength(found["strength"])
        plot = Plot("strength", caption, figure)
        shown.append({"caption": caption, "plot": plot, "wide": False})
    if found.get("confusion"):
        caption = "What was hidden, and what was said; the list below holds the same numbers"
        figure = trial_figures.confusion(found["confusion"])
        plot = Plot("confusion", caption, figure)
        shown.append({"caption": caption, "plot": plot, "wide": True})
    return shown


def said_of(said: Mapping[str, int]) -> str:
    """What was said of one hidden kind, the most frequent first."""
    ordered = sorted(said.items(), key=lambda pair: (-pair[1], pair[0]))
    return ", ".join(f"{spoken(name)} {count}×" for name, count in ordered)


def spoken(name: str) -> str:
    """A kind's or effect's name without underscores."""
    return name.replace("_", " ")
