"""The figures of what size rests on: predictors side by side, number of samples, features."""

from collections.abc import Mapping, Sequence
from typing import Any

import plotly.graph_objects as go

from spirob.report.figures import BASE, NAMED, bars, blank

DOMAINS = {
    "simulation": ("simulation", NAMED, "circle"),
    "robot": ("robot", BASE, "diamond"),
}
MAE = "mean absolute error [mm]"
TICKS = (0.5, 1, 2, 5, 10, 20)  # mm


def predictors(errors: Mapping[str, Mapping[str, Mapping[str, float]]]) -> go.Figure:
    """MAE of each predictor with its 95 % interval, by domain; a logarithmic axis.

    errors  name of the predictor -> domain -> mae, mae_low, mae_high [mm]
    """
    figure = bars(110 + 36 * len(errors), scattermode="group", scattergap=0.6)
    for domain, (name, colour, symbol) in DOMAINS.items():
        kept = {label: one[domain] for label, one in errors.items() if domain in one}
        figure.add_scatter(
            x=[one["mae"] for one in kept.values()],
            y=list(kept),
            mode="markers",
            name=name,
            marker={"color": colour, "symbol": symbol, "size": 9},
            error_x=_interval(list(kept.values()), colour),
            hovertemplate="%{x:.2f} mm<extra>%{y}, " + name + "</extra>",
        )
    figure.update_xaxes(title_text=MAE, type="log", tickvals=TICKS, rangemode="normal")
    return figure


def learning_curve(curve: Mapping[str, Mapping[str, Mapping[str, float]]]) -> go.Figure:
    """MAE over the number of training samples, with its 95 % interval over the wraps tested.

    curve  number of samples -> domain -> mae, mae_low, mae_high [mm]
    """
    figure = blank(360)
    counts = [int(count) for count in curve]
    for domain, (name, colour, symbol) in DOMAINS.items():
        steps = [one[domain] for one in curve.values()]
        figure.add_scatter(
            x=counts,
            y=[step["mae"] for step in steps],
            mode="lines+markers",
            name=name,
            line={"color": colour, "width": 1.8},
            marker={"color": colour, "symbol": symbol, "size": 8},
            error_y=_interval(steps, colour),
            hovertemplate="%{x} wraps: %{y:.2f} mm<extra>" + name + "</extra>",
        )
    figure.update_xaxes(title_text="wraps learned from", type="log", tickvals=counts)
    figure.update_yaxes(title_text=MAE, rangemode="tozero")
    return figure


def importance(grown: Mapping[str, float], meanings: Mapping[str, str]) -> go.Figure:
    """By how much the MAE in simulation grows when one feature is shuffled [mm], most first."""
    figure = bars(90 + 26 * len(grown))
    figure.add_bar(
        x=list(grown.values()),
        y=[name.replace("_", " ") for name in grown],
        orientation="h",
        marker={"color": NAMED},
        customdata=[meanings.get(name, "") for name in grown],
        hovertemplate="%{x:.1f} mm<br>%{customdata}<extra>%{y}</extra>",
        showlegend=False,
    )
    figure.update_xaxes(title_text="growth of the mean absolute error in simulation [mm]")
    return figure


def _interval(errors: Sequence[Mapping[str, float]], colour: str) -> dict[str, Any]:
    return {
        "type": "data",
        "array": [one["mae_high"] - one["mae"] for one in errors],
        "arrayminus": [one["mae"] - one["mae_low"] for one in errors],
        "color": colour,
        "thickness": 1.2,
        "width": 3,
    }
