"""The figures, as plotly describes them; colours are names that the page's style resolves.

Horizontal bars throughout: labels are read without turning the head, on a phone too.
"""

import json
import textwrap
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
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
