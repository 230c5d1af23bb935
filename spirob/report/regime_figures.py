"""The figures of regimes: shares of the base model's error, and errors before and after."""

from collections.abc import Mapping, Sequence
from typing import Any

import plotly.graph_objects as go

from spirob.report.figures import BASE, NAMED, NEUTRAL, bars, wrap
from spirob.report.numbers import percent

MOST = 12  # regimes in the figure of errors: more are read in the table of the atlas


def atlas(regimes: Sequence[dict[str, Any]]) -> go.Figure:
    """Share of squared error beside share of time, one pair of bars for each regime."""
    figure = bars(120 + 46 * len(regimes), barmode="group", bargap=0.28, bargroupgap=0.05)
    labels = [wrap(regime["regime"], 26) for regime in regimes]
    for name, key, colour in (
        ("share of squared error", "share_of_error", BASE),
        ("share of time", "share_of_time", NEUTRAL),
    ):
        shares = [regime[key] for regime in regimes]
        figure.add_bar(
            x=[None if share is None else 100 * share for share in shares],
            y=labels,
            orientation="h",
            name=name,
            marker={"color": colour},
            customdata=[regime["regime"] for regime in regimes],
            text=[percent(share) for share in shares],
            textposition="outside",
            cliponaxis=False,
            hovertemplate="%{x:.1f} %<extra>%{y}, " + name + "</extra>",
        )
    top = max(100 * (r[k] or 0) for r in regimes for k in ("share_of_error", "share_of_time"))
    figure.update_xaxes(title_text="share [%]", range=[0, 1.14 * top])
    return figure


def regimes(errors: Mapping[str, float]) -> go.Figure:
    """RMSE of the worst regimes [mA] for the base model, and room for that of another."""
    ordered = sorted(errors, key=lambda name: -errors[name])[:MOST]
    figure = bars(120 + 40 * len(ordered), barmode="group", bargap=0.28, bargroupgap=0.05)
    labels = [wrap(name, 26) for name in ordered]
    for name, colour, shown in (("base model", BASE, True), ("with the effects", NAMED, False)):
        figure.add_bar(
            x=[errors[regime] for regime in ordered],
            y=labels,
            orientation="h",
            name=name,
            visible=shown,
            marker={"color": colour},
            customdata=ordered,
            hovertemplate="%{x:.3g} mA<extra>%{y}, " + name + "</extra>",
        )
    figure.update_xaxes(title_text="RMSE of current [mA]", range=[0, 1.05 * max(errors.values())])
    return figure
