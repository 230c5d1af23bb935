"""Measured and modelled effort of each trial, and under it what each model leaves."""

from typing import Any

import numpy as np
import pandas as pd
import plotly.graph_objects as go

from spirob.report.data import ReportData
from spirob.report.figures import Plot, blank
from spirob.report.sections import Section
from spirob.report.sections.comparison import LOOKS

MOST_TRIALS = 6  # held-out ones first
MOST_SAMPLES = 2000
HEIGHT = 420  # pixels
Signals = dict[str, tuple[np.ndarray, np.ndarray | None]]  # by origin: above, below


class RigOverlay(Section):
    """One figure for each trial."""

    order = 20
    title = "Comparison"
    template = "rig_overlay.html.j2"
    pages = ("rig",)

    def get_context(self, data: ReportData) -> dict[str, Any]:
        diagnosis = data.diagnosis
        groups = list(data.overlay.groupby(["role", "trial"], sort=False))
        named = " + ".join(e["name"].replace("_", " ") for e in diagnosis["effects"])
        plots = []
        for k, ((role, trial), rows) in enumerate(groups[:MOST_TRIALS]):
            label = f"{trial}, {'held out' if role == 'test' else 'fitted'}"
            figure = trial_figure(rows, named, diagnosis["effort"], diagnosis["unit"])
            plots.append((label, Plot(f"trial-{k}", f"Measured and modelled: {label}", figure)))
        return {"plots": plots, "more": max(0, len(groups) - MOST_TRIALS)}


def trial_figure(rows: pd.DataFrame, named: str, effort: str, unit: str) -> go.Figure:
    """Effort above, residuals below; `named` is empty where no effect was named."""
    kept = thinned(rows)
    measured = kept["measured"].to_numpy(float)
    signals: Signals = {"measured": (measured, None)}
    for origin in models(named):
        values = kept[origin].to_numpy(float)
        signals[origin] = (values, values - measured)
    return stacked(kept["time"], signals, named, effort, unit)


def thinned(rows: pd.DataFrame) -> pd.DataFrame:
    """As many of the rows as a figure shows."""
    return rows.iloc[:: max(1, -(-len(rows) // MOST_SAMPLES))]


def models(named: str) -> list[str]:
    """The models that are drawn: without effects and, where one was named, with it."""
    return ["base", "named"] if named else ["base"]


def stacked(
    seconds: pd.Series, signals: Signals, named: str, quantity: str, unit: str
) -> go.Figure:
    """The signals over time, and below each model's what it misses of the measured one."""
    time = [round(float(t), 4) for t in seconds]
    names = {"measured": "measured", "base": "fitted numbers", "named": f"with {named}"}
    figure = blank(HEIGHT, hovermode="x", dragmode="zoom")
    for origin, drawn in signals.items():
        for axis, values in zip(("y", "y2"), drawn, strict=True):
            if values is None:
                continue
            figure.add_scatter(
                x=time,
                y=[float(f"{v:.5g}") for v in values],
                name=names[origin],
                legendgroup=origin,
                showlegend=axis == "y",
                line=LOOKS[origin],
                mode="lines",
                yaxis=axis,
                hovertemplate=f"%{{y:.4g}} {unit}",
            )
    figure.update_layout(
        xaxis={"title": {"text": "time [s]"}, "anchor": "y2"},
        yaxis={"domain": [0.42, 1.0], "title": {"text": f"{quantity} [{unit}]"}},
        yaxis2={"domain": [0.0, 0.34], "title": {"text": f"model − measured [{unit}]"}},
    )
    return figure
