"""The figures of a trial: who is taken for whom, and whether probabilities and strengths hold."""

from collections.abc import Mapping, Sequence
from typing import Any

import plotly.graph_objects as go

from spirob.report.figures import BASE, INK, NAMED, NEUTRAL, blank

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
    shares = [[n / total for n in line] for line, total in zip(counts, totals, strict=True)]
    figure = blank(190 + ROW * len(rows))
    figure.add_heatmap(
        z=shares,
        x=[said.replace("_", " ") for said in columns],
        y=[kind.replace("_", " ") for kind in rows],
        text=[[str(n) if n else "" for n in line] for line in counts],
        texttemplate="%{text}",
        colorscale=[[0.0, "var(--surface)"], [1.0, NAMED]],
        zmin=0.0,
        zmax=1.0,
        xgap=1,
        ygap=1,
        showscale=False,
        hovertemplate="hidden: %{y}<br>said: %{x}<br>%{text} of the row, %{z:.0%}<extra></extra>",
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
        x=[0, 1],
        y=[0, 1],
        mode="lines",
        name="as sure as right",
        line={"color": NEUTRAL, "width": 1, "dash": "dot"},
        hoverinfo="skip",
    )
    kept = [one for one in bins if one.get("n") and one.get("right") is not None]
    figure.add_scatter(
        x=[one["said"] for one in kept],
        y=[one["right"] for one in kept],
        error_y=_interval(kept, "right"),
        mode="markers+text",
        name="robots, their number beside",
        text=[str(one["n"]) for one in kept],
        textposition="middle right",
        marker={"color": NAMED, "size": 10, "symbol": "diamond"},
        customdata=[[one["low"], one["high"]] for one in kept],
        hovertemplate="said %{x:.0%}, right %{y:.0%} of %{text}<br>"
        "bin %{customdata[0]:.0%} to %{customdata[1]:.0%}<extra></extra>",
    )
    figure.update_xaxes(title_text="probability said", range=[0, 1.08], tickformat=".0%")
    figure.update_yaxes(title_text="share that was right", range=[-0.03, 1.08], tickformat=".0%")
    return figure


def strength(bins: Sequence[Mapping[str, Any]]) -> go.Figure:
    """Rate of right names in each bin of what knowing the effect leaves of the held-out error."""
    figure = blank(330)
    kept = [one for one in bins if one.get("n") and one.get("value") is not None]
    middle = [(one["low"] + one["high"]) / 2 for one in kept]
    half = [(one["high"] - one["low"]) / 2 for one in kept]
    figure.add_scatter(
        x=middle,
        y=[one["value"] for one in kept],
        mode="markers+text",
        name="rate and its 95 % interval, number of robots beside",
        text=[str(one["n"]) for one in kept],
        textposition="top right",
        marker={"color": BASE, "size": 9},
        error_x={"type": "data", "array": half, "color": NEUTRAL, "thickness": 1, "width": 0},
        error_y=_interval(kept, "value"),
        hovertemplate="%{x:.0%} left: named rightly %{y:.0%} of %{text}<extra></extra>",
    )
    figure.update_xaxes(title_text="held-out error left when it is known", tickformat=".0%")
    figure.update_yaxes(title_text="named rightly", range=[-0.03, 1.08], tickformat=".0%")
    return figure


def _interval(bins: Sequence[Mapping[str, Any]], key: str) -> dict[str, Any]:
    """Bars of the 95 % interval about each rate."""
    above = [max(one.get("high_ci", one[key]) - one[key], 0) for one in bins]
    below = [max(one[key] - one.get("low_ci", one[key]), 0) for one in bins]
    return {"type": "data", "array": above, "arrayminus": below, "color": INK, "width": 4}
