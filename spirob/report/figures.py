"""The figures, as plotly describes them; colours are names that the page's style resolves.

Horizontal bars throughout: labels are read without turning the head, on a phone too.
"""

import json
import textwrap
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any

import plotly.graph_objects as go

MEASURED, BASE, NAMED = "var(--measured)", "var(--base)", "var(--named)"
NEUTRAL, GRID, INK = "var(--neutral)", "var(--grid)", "var(--ink)"
CLEAR = "rgba(0,0,0,0)"
LABEL_WIDTH = 22  # characters before a label takes a second line


@dataclass(frozen=True)
class Plot:
    """A figure with the id of its place on the page and a sentence for those who cannot see it."""

    name: str
    label: str
    figure: go.Figure

    @property
    def height(self) -> int:
        """Height in pixels, kept free before the figure is drawn."""
        return int(self.figure.layout.height)

    @property
    def content(self) -> Any:
        """What the page's script draws."""
        return json.loads(self.figure.to_json())


def blank(height: int, **layout: Any) -> go.Figure:
    """A figure with the page's manners: no frame, thin grid, room made for labels."""
    axis = {
        "gridcolor": GRID,
        "zerolinecolor": NEUTRAL,
        "linecolor": NEUTRAL,
        "automargin": True,
        "title": {"standoff": 8, "font": {"size": 13}},
    }
    figure = go.Figure()
    figure.update_layout(
        template=go.layout.Template(layout={"xaxis": axis, "yaxis": axis}),
        height=height,
        margin={"l": 8, "r": 12, "t": 8, "b": 8},
        paper_bgcolor=CLEAR,
        plot_bgcolor=CLEAR,
        font={"color": INK, "size": 13},
        legend={"orientation": "h", "x": 0, "y": 1.02, "yanchor": "bottom"},
        hoverlabel={"bgcolor": "var(--surface)", "font": {"color": INK}},
        dragmode=False,
    )
    figure.update_layout(**layout)
    return figure


def size(
    points: Mapping[str, tuple[Sequence[float], Sequence[float]]],
    half_widths: Mapping[str, float] | None = None,
) -> go.Figure:
    """Predicted over true diameter [mm] with the line of a perfect estimate.

    half_widths  of the interval [mm] that comes with each size, by domain
    """
    figure = blank(430)
    every = [value for pair in points.values() for values in pair for value in values]
    low, high = min(every) - 4, max(every) + 4
    figure.add_scatter(
        x=[low, high],
        y=[low, high],
        mode="lines",
        name="perfect",
        line={"color": NEUTRAL, "width": 1, "dash": "dot"},
        hoverinfo="skip",
    )
    looks = {"simulation": (NAMED, "circle-open"), "robot": (BASE, "diamond-open")}
    for domain, (true, predicted) in points.items():
        colour, symbol = looks.get(domain, (INK, "cross"))
        figure.add_scatter(
            x=list(true),
            y=list(predicted),
            mode="markers",
            name=domain,
            marker={"color": colour, "symbol": symbol, "size": 8, "line": {"width": 1.6}},
            error_y=_bar((half_widths or {}).get(domain), colour),
            hovertemplate="true %{x:.1f} mm, predicted %{y:.1f} mm<extra>" + domain + "</extra>",
        )
    figure.update_xaxes(
        title_text="true diameter [mm]", range=[low, high], constrain="domain", dtick=10
    )
    figure.update_yaxes(
        title_text="predicted diameter [mm]",
        range=[low, high],
        dtick=10,
        scaleanchor="x",
        constrain="domain",
    )
    return figure


def _bar(half: float | None, colour: str) -> dict[str, Any]:
    if half is None:
        return {"visible": False}
    return {"type": "constant", "value": half, "color": colour, "thickness": 0.7, "width": 2}


def wrap(label: str, width: int = LABEL_WIDTH) -> str:
    """A label over several lines."""
    return "<br>".join(textwrap.wrap(label, width)) or label


def bars(height: int, **layout: Any) -> go.Figure:
    """A figure for horizontal bars, the first on top."""
    figure = blank(height, **{"bargap": 0.35, **layout})
    figure.update_yaxes(autorange="reversed", showgrid=False, ticks="", ticklabelstandoff=6)
    figure.update_xaxes(rangemode="tozero")
    return figure


DOMAINS = {"simulation": ("simulation", NAMED), "robot": ("robot", BASE)}
THRESHOLDS = {"paper": ("the paper's", "dot", "diamond"), "tuned": ("tuned", "solid", "star")}
WITHIN = "20"  # mm of further travel that a hit may take
DECADES = (0.01, 0.1, 1.0, 10.0, 100.0)  # false alarms a minute that have a label
APART = (-0.9, -0.3, 0.3, 0.9)  # % of the length, so that bars do not cover each other
HITS = f"told within {WITHIN} mm of travel"


def roc(signal: Mapping[str, Any]) -> go.Figure:
    """Share of contacts told over false alarms a minute, with both thresholds marked.

    The axis is logarithmic; no alarm at all is drawn at its left edge.
    """
    figure = blank(360)
    none = left_edge(signal)
    for domain, (name, colour) in DOMAINS.items():
        points = signal[domain]["roc"]
        figure.add_scatter(
            x=[max(point["alarms"], none) for point in points],
            y=[100 * point["hits"] for point in points],
            mode="lines+markers",
            name=name,
            line={"color": colour, "width": 1.5},
            marker={"color": colour, "size": 4},
            customdata=[[point["alarms"], point["scale"]] for point in points],
            hovertemplate="%{y:.0f} % told, %{customdata[0]:.2g} false alarms a minute<br>"
            "thresholds %{customdata[1]:.2g} times the paper's<extra>" + name + "</extra>",
        )
    for rules, domain in product(THRESHOLDS, DOMAINS):
        (how, _, symbol), (name, colour) = THRESHOLDS[rules], DOMAINS[domain]
        found = signal[domain][rules]
        edge = {"color": INK, "width": 1}
        figure.add_scatter(
            x=[max(found["alarms"], none)],
            y=[100 * found["hits"][WITHIN]],
            mode="markers",
            name=f"{how}, {name}",
            marker={"color": colour, "symbol": symbol, "size": 13, "line": edge},
            hovertemplate="%{y:.0f} % told<extra>" + f"{how}, {name}</extra>",
        )
    shown = [decade for decade in DECADES if decade > 1.5 * none]
    figure.update_xaxes(
        title_text="false alarms a minute of free motion [1/min]",
        type="log",
        tickvals=[none, *shown],
        ticktext=["0", *(f"{decade:g}" for decade in shown)],
        zeroline=False,
    )
    figure.update_yaxes(title_text=f"contacts {HITS}", range=[-3, 105], ticksuffix=" %")
    return figure


def left_edge(signal: Mapping[str, Any]) -> float:
    """Where no alarm at all is drawn: a third of the least rate that any threshold has [1/min]."""
    rates = [point["alarms"] for domain in DOMAINS for point in signal[domain]["roc"]]
    return min((rate for rate in rates if rate > 0.0), default=1.0) / 3.0


def hits_along(signal: Mapping[str, Any]) -> go.Figure:
    """Share of contacts told in time, over the place along the arm."""
    figure = blank(330)
    for name, look, parts in _lines(signal):
        figure.add_scatter(
            x=[100 * part["place"] for part in parts],
            y=[100 * part["hits"][WITHIN] for part in parts],
            name=name,
            customdata=[part["contacts"] for part in parts],
            hovertemplate="%{x:.0f} % of the length: %{y:.0f} % of %{customdata} told"
            f"<extra>{name}</extra>",
            **look,
        )
    _place_axis(figure)
    figure.update_yaxes(title_text=HITS, range=[-3, 105], ticksuffix=" %")
    return figure


def delay_along(signal: Mapping[str, Any]) -> go.Figure:
    """Median delay from onset to decision [ms] over the place, up to that of 95 %."""
    figure = blank(330)
    for apart, (name, look, parts) in zip(APART, _lines(signal), strict=True):
        told = [part for part in parts if part["delay"]]
        median = [part["delay"][0] for part in told]
        above = [part["delay"][1] - part["delay"][0] for part in told]
        bars = {"type": "data", "array": above, "arrayminus": [0.0] * len(told)}
        figure.add_scatter(
            x=[100 * part["place"] + apart for part in told],
            y=median,
            name=name,
            error_y={**bars, "thickness": 0.8, "width": 3},
            customdata=[100 * part["place"] for part in told],
            hovertemplate="%{customdata:.0f} % of the length: %{y:.0f} ms"
            f"<extra>{name}</extra>",
            **look,
        )
    _place_axis(figure)
    figure.update_yaxes(title_text="delay, median to 95 % [ms]", rangemode="tozero")
    return figure


def _lines(
    signal: Mapping[str, Any],
) -> Iterable[tuple[str, dict[str, Any], Sequence[Mapping[str, Any]]]]:
    """Name, look and parts that hold a contact, for each domain and thresholds."""
    for domain, (name, colour) in DOMAINS.items():
        for rules, (how, dash, symbol) in THRESHOLDS.items():
            look = {
                "mode": "lines+markers",
                "line": {"color": colour, "dash": dash, "width": 1.8},
                "marker": {"color": colour, "symbol": symbol, "size": 8},
            }
            parts = [p for p in signal[domain][rules].get("by_place", []) if p["contacts"]]
            yield f"{how}, {name}", look, parts


def _place_axis(figure: go.Figure) -> None:
    figure.update_xaxes(title_text="place of the contact [% of the arm's length]", dtick=10)


SIZE_DOMAINS = {
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
    for domain, (name, colour, symbol) in SIZE_DOMAINS.items():
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
    for domain, (name, colour, symbol) in SIZE_DOMAINS.items():
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
