"""The paper's experiments: robot, model and baseline, beside the paper's figures.

A figure for each quantity, its trials side by side, every side a line.
"""

from collections.abc import Sequence
from typing import Any

import plotly.graph_objects as go
from plotly.subplots import make_subplots

from spirob.report.data import ReportData
from spirob.report.figures import BASE, INK, MEASURED, NAMED, NEUTRAL, Plot, blank
from spirob.report.sections import Section
from spirob.report.words import MISSING, is_number, number, unit_text

SIDES = ("robot", "base", "named", "single")
MET = {True: "met", False: "missed", None: ""}


class Experiments(Section):
    """One table and its overlays for each experiment."""

    order = 55
    title = "The paper's experiments"
    template = "experiments.html.j2"

    def get_context(self, data: ReportData) -> dict[str, Any]:
        if data.experiments is None:
            return {"experiments": [], "met": 0, "aims": 0, "reason": data.absent["experiments"]}
        found = [_experiment(name, one) for name, one in data.experiments.items()]
        rows = [row for one in data.experiments.values() for row in one["rows"]]
        aims = [row["met"] for row in rows if isinstance(row["met"], bool)]
        unjudged = sum(isinstance(row["met"], str) for row in rows)
        counts = {"met": sum(aims), "aims": len(aims), "unjudged": unjudged}
        return {"experiments": found, "reason": "", **counts}


def _experiment(name: str, one: dict[str, Any]) -> dict[str, Any]:
    first = [r for r in one["rows"] if r["aim"] or r["paper"] is not None]
    return {
        "title": one["title"],
        "about": one.get("about", ""),
        "rows": [_row(r) for r in first],
        "others": [_row(r) for r in one["rows"] if r not in first],
        "plots": overlays(name, one["curves"]),
    }


def _row(row: dict[str, Any]) -> dict[str, Any]:
    notes = [row["note"], f"aim: {row['aim']}" if row["aim"] else ""]
    return {
        "what": row["what"],
        "unit": unit_text(row["unit"]),
        "cells": [_cell(row[side]) for side in SIDES],
        "paper": _cell(row["paper"]),
        "verdict": MET.get(row["met"], row["met"]),
        "note": "; ".join(note for note in notes if note),
    }


def _cell(value: Any) -> str:
    if isinstance(value, str):
        return value
    return number(value) if is_number(value) else MISSING


LOOKS = {
    "robot": ("robot", MEASURED, "solid"),
    "base": ("base model", BASE, "solid"),
    "named": ("with effect", NAMED, "solid"),
    "single": ("single dynamics", NEUTRAL, "dot"),
}
AXES = {
    "displacement over force": "force [N]",
    "current over force": "force [N]",
    "filtered current over force": "force [N]",
    "angle response": "place of the hit [% of length]",
    "current peak": "place of the hit [% of length]",
    "reconstructed current peak": "place of the hit [% of length]",
    "sensitivity along the arm": "place of the hit [% of length]",
    "reconstructed sensitivity along the arm": "place of the hit [% of length]",
    "current after a hit": "time since the hit [s]",
    "reconstructed current": "time since the hit [s]",
    "amplitude of the current": "frequency [Hz]",
    "amplitude of the reconstructed current": "frequency [Hz]",
    "stiffness along the arm": "place [% of length]",
    "inertia along the arm": "place [% of length]",
    "give along the arm": "place [% of length]",
}
UPRIGHT = {
    "displacement over force": "displacement",
    "current over force": "current",
    "filtered current over force": "filtered current",
    "filtered": "filtered current",
    "reconstructed": "reconstructed current",
    "sensitivity along the arm": "sensitivity",
    "reconstructed sensitivity along the arm": "sensitivity, reconstructed",
    "amplitude of the current": "amplitude",
    "amplitude of the reconstructed current": "amplitude, reconstructed",
    "stiffness along the arm": "stiffness of the hinge",
    "inertia along the arm": "inertia beyond",
    "give along the arm": "give of the arm",
}
RECONSTRUCTED = (
    "reconstructed",
    "reconstructed current",
    "reconstructed current peak",
    "reconstructed sensitivity along the arm",
    "amplitude of the reconstructed current",
)
NOTES = dict.fromkeys(RECONSTRUCTED, "; i** of the models, the measured current of the robot")
POINTS = 12  # a line of fewer points shows them
COLUMNS = 2
ROW = 250  # pixels
FLATTENS = 3.0  # times the span of the others


def overlays(name: str, curves: Sequence[dict[str, Any]]) -> list[Plot]:
    """One plot for each quantity of an experiment."""
    quantities = dict.fromkeys((c["quantity"], c["unit"]) for c in curves)
    return [
        Plot(
            f"experiment-{name}-{k}",
            _caption(quantity, [c for c in curves if c["quantity"] == quantity]),
            _overlay([c for c in curves if c["quantity"] == quantity], quantity, unit),
        )
        for k, (quantity, unit) in enumerate(quantities)
    ]


def _overlay(curves: Sequence[dict[str, Any]], quantity: str, unit: str) -> go.Figure:
    plays = list(dict.fromkeys(c["play"] for c in curves))
    across = min(COLUMNS, len(plays))
    down = -(-len(plays) // across)
    figure = make_subplots(
        rows=down,
        cols=across,
        subplot_titles=plays if len(plays) > 1 else None,
        vertical_spacing=0.24 / down,
        horizontal_spacing=0.12,
    )
    figure.update_layout(blank(80 + ROW * down).layout)
    shown: set[str] = set()
    for one in curves:
        place = plays.index(one["play"])
        label, colour, dash = LOOKS[one["side"]]
        figure.add_scatter(
            x=one["x"],
            y=one["y"],
            mode="lines+markers" if len(one["x"]) <= POINTS else "lines",
            name=label,
            legendgroup=label,
            showlegend=label not in shown,
            line={"color": colour, "dash": dash, "width": 1.6},
            hovertemplate=f"%{{y:.4g}} {unit}<extra>{label}</extra>",
            row=place // across + 1,
            col=place % across + 1,
        )
        shown.add(label)
    figure.update_annotations(font={"size": 12, "color": INK})
    below = AXES.get(quantity, "time [s]")
    for place in range(len(plays) - across, len(plays)):  # the lowest of each column
        figure.update_xaxes(title_text=below, row=place // across + 1, col=place % across + 1)
    figure.update_yaxes(title_text=f"{UPRIGHT.get(quantity, quantity)} [{unit}]", col=1)
    if (limits := _limits(curves)) is not None:
        figure.update_yaxes(range=limits)
    figure.update_layout(legend={"y": 1.0 + 34 / (ROW * down)}, margin={"t": 60})
    return figure


def _caption(quantity: str, curves: Sequence[dict[str, Any]]) -> str:
    """What the figure shows, and that the baseline leaves it where it does."""
    upright = UPRIGHT.get(quantity, quantity).capitalize()
    over = AXES.get(quantity, "time [s]").partition(" [")[0]
    cut = "; single dynamics leaves the figure" if _limits(curves) is not None else ""
    return f"{upright} over {over}{NOTES.get(quantity, '')}{cut}"


def _limits(curves: Sequence[dict[str, Any]]) -> tuple[float, float] | None:
    """Limits that show the sides with motors, where the baseline would flatten them to a line."""
    low, high = _span([c for c in curves if c["side"] != "single"])
    bare = _span([c for c in curves if c["side"] == "single"])
    if bare[1] - bare[0] <= FLATTENS * (high - low) or high <= low:
        return None
    margin = 0.25 * (high - low)
    return low - margin, high + margin


def _span(curves: Sequence[dict[str, Any]]) -> tuple[float, float]:
    values = [y for c in curves for y in c["y"]]
    return (min(values), max(values)) if values else (0.0, 0.0)
