"""How far the verdict can be trusted: a diagnosis of many robots whose truth is known.

Which one, where it is not the present one, the results say (`by`).  The figures show who is taken
for whom, and whether probabilities and strengths hold.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import plotly.graph_objects as go

from spirob.report.data import ReportData
from spirob.report.figures import BASE, INK, NAMED, NEUTRAL, Plot, blank
from spirob.report.sections import Section
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
    "law_composed": "the same, where the effect shows: a law is composed",
    "law_within_1.3": "its held-out error at most 1.3 times that of knowing the effect",
    "law_within_2.0": "the same, at most 2 times",
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
            "by": found.get("by"),
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
        figure = reliability(found["reliability"])
        plot = Plot("reliability", caption, figure)
        shown.append({"caption": caption, "plot": plot, "wide": False})
    if found.get("strength"):
        caption = "How strong must it be? Right names over the error that is left when it is known"
        figure = strength(found["strength"])
        plot = Plot("strength", caption, figure)
        shown.append({"caption": caption, "plot": plot, "wide": False})
    if found.get("confusion"):
        caption = "What was hidden, and what was said; the list below holds the same numbers"
        figure = confusion(found["confusion"])
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


REFUSALS = ("undecided", "unknown", "nothing_missing")  # answers that name nothing, at the end
ROW = 24  # pixels
WIDEST = 0.12  # of the figure, that one column may take


def confusion(table: Mapping[str, Mapping[str, int]]) -> go.Figure:
    """A row for each hidden kind, a column for each answer, the share of the row as colour.

    Columns are in the order in which rows are answered most often, so that right answers lie
    along a diagonal.
    """
    rows, columns = list(table), answers(table)
    totals = [max(sum(table[kind].values()), 1) for kind in rows]
    counts = [[table[kind].get(said, 0) for said in columns] for kind in rows]
    shares = [[100 * n / total for n in line] for line, total in zip(counts, totals, strict=True)]
    figure = blank(190 + ROW * len(rows))
    figure.add_heatmap(
        z=shares,
        x=[said.replace("_", " ") for said in columns],
        y=[kind.replace("_", " ") for kind in rows],
        text=[[str(n) if n else "" for n in line] for line in counts],
        texttemplate="%{text}",
        colorscale=[[0.0, "var(--surface)"], [1.0, NAMED]],
        zmin=0.0,
        zmax=100.0,
        xgap=1,
        ygap=1,
        showscale=False,
        hovertemplate="hidden: %{y}<br>said: %{x}<br>%{text} of the row, %{z:.0f} %<extra></extra>",
    )
    figure.update_yaxes(title_text="hidden", autorange="reversed", showgrid=False, dtick=1)
    figure.update_xaxes(title_text="said", tickangle=-60, showgrid=False, dtick=1)
    figure.update_xaxes(domain=[0, min(1.0, WIDEST * len(columns))])
    return figure


def answers(table: Mapping[str, Mapping[str, int]]) -> list[str]:
    """All answers: the leading one of each row first, then the others, refusals last."""
    leading = []
    for said in table.values():
        named = {name: n for name, n in said.items() if name not in REFUSALS}
        if named:
            leading.append(max(named, key=lambda name: (named[name], name)))
    every = dict.fromkeys([*leading, *(name for said in table.values() for name in said)])
    return [*(n for n in every if n not in REFUSALS), *(n for n in REFUSALS if n in every)]


def reliability(bins: Sequence[Mapping[str, Any]]) -> go.Figure:
    """Share of right names in each bin of the said probability, with the line of a true one."""
    figure = blank(330)
    figure.add_scatter(
        x=[0, 100],
        y=[0, 100],
        mode="lines",
        name="as sure as right",
        line={"color": NEUTRAL, "width": 1, "dash": "dot"},
        hoverinfo="skip",
    )
    kept = [one for one in bins if one.get("n") and one.get("right") is not None]
    figure.add_scatter(
        x=[100 * one["said"] for one in kept],
        y=[100 * one["right"] for one in kept],
        error_y=_interval(kept, "right"),
        mode="markers+text",
        name="robots, their number beside",
        text=[str(one["n"]) for one in kept],
        textposition="middle right",
        marker={"color": NAMED, "size": 10, "symbol": "diamond"},
        customdata=[[100 * one["low"], 100 * one["high"]] for one in kept],
        hovertemplate="said %{x:.0f} %, right %{y:.0f} % of %{text}<br>"
        "bin %{customdata[0]:.0f} % to %{customdata[1]:.0f} %<extra></extra>",
    )
    figure.update_xaxes(title_text="probability said", range=[0, 108], ticksuffix=" %")
    figure.update_yaxes(title_text="share that was right", range=[-3, 108], ticksuffix=" %")
    return figure


def strength(bins: Sequence[Mapping[str, Any]]) -> go.Figure:
    """Rate of right names in each bin of what knowing the effect leaves of the held-out error."""
    figure = blank(330)
    kept = [one for one in bins if one.get("n") and one.get("value") is not None]
    middle = [50 * (one["low"] + one["high"]) for one in kept]
    half = [50 * (one["high"] - one["low"]) for one in kept]
    figure.add_scatter(
        x=middle,
        y=[100 * one["value"] for one in kept],
        mode="markers+text",
        name="rate and its 95 % interval, number of robots beside",
        text=[str(one["n"]) for one in kept],
        textposition="top right",
        marker={"color": BASE, "size": 9},
        error_x={"type": "data", "array": half, "color": NEUTRAL, "thickness": 1, "width": 0},
        error_y=_interval(kept, "value"),
        hovertemplate="%{x:.0f} % left: named rightly %{y:.0f} % of %{text}<extra></extra>",
    )
    figure.update_xaxes(title_text="held-out error left when it is known", ticksuffix=" %")
    figure.update_yaxes(title_text="named rightly", range=[-3, 108], ticksuffix=" %")
    return figure


def _interval(bins: Sequence[Mapping[str, Any]], key: str) -> dict[str, Any]:
    """Bars of the 95 % interval about each rate, in per cent."""
    above = [100 * max(one.get("high_ci", one[key]) - one[key], 0) for one in bins]
    below = [100 * max(one[key] - one.get("low_ci", one[key]), 0) for one in bins]
    return {"type": "data", "array": above, "arrayminus": below, "color": INK, "width": 4}
