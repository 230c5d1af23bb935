"""The ladder as a figure: the error of each rung, between two ceilings.

One ceiling is what a flexible model leaves, the other the noise of the sensor.
"""

from collections.abc import Sequence
from typing import Any

import plotly.graph_objects as go

from spirob.report.figures import BASE, INK, NAMED, NEUTRAL, Plot, bars, wrap
from spirob.report.numbers import EFFORT, column, is_number

LABEL = (
    "Bars of the error of each model on held-out and on training trials with 95 % intervals, "
    "and lines where a flexible model and the sensor's noise are; section Ladder has the numbers"
)
SPLITS = {"heldout": "held-out trials", "train": "training trials (pale)"}
FAINT = 0.4  # of the training bars


def ladder_plot(rungs: Sequence[dict[str, Any]], noise_floor: float | None, unit: str) -> Plot:
    """The figure in its place on the page."""
    return Plot("steps", LABEL, ladder(rungs, noise_floor, unit))


def ladder(rungs: Sequence[dict[str, Any]], noise_floor: float | None, unit: str) -> go.Figure:
    """RMSE of each rung on held-out and training trials, with intervals and both ceilings."""
    figure = bars(150 + 54 * len(rungs), barmode="group", bargap=0.3)
    labels = [wrap(rung["label"].replace("_", " ")) for rung in rungs]
    for split, title in SPLITS.items():
        figure.add_bar(
            x=[rmse(rung, split) for rung in rungs],
            y=labels,
            orientation="h",
            name=title,
            marker={"color": _colours(rungs), "opacity": 1.0 if split == "heldout" else FAINT},
            error_x=_whiskers(rungs, split),
            hovertemplate=f"%{{x:.3g}} {unit}<extra>%{{y}}, {title}</extra>",
        )
    ends = [max((v for v in _reach(rung) if is_number(v)), default=None) for rung in rungs]
    figure.add_scatter(
        x=ends,
        y=labels,
        mode="text",
        text=[f" {text}" for text in column([rmse(rung, "heldout") for rung in rungs])],
        textposition="middle right",
        cliponaxis=False,
        showlegend=False,
        hoverinfo="skip",
    )
    top = max((v for v in ends if v is not None), default=1.0)
    figure.update_xaxes(
        title_text=f"RMSE of {EFFORT.get(unit, 'effort')} [{unit}]", range=[0, 1.22 * top]
    )
    above = next((rmse(rung, "heldout") for rung in rungs if rung.get("ceiling")), None)
    _line(figure, above, "flexible model, held out", unit, "dash")
    _line(figure, noise_floor, "sensor noise", unit, "dot")
    return figure


def rmse(rung: dict[str, Any], split: str) -> float | None:
    """RMSE of a rung on some trials, if it has one."""
    return (rung.get(split) or {}).get("rmse")


def interval(rung: dict[str, Any], split: str, score: str = "rmse") -> tuple[Any, Any]:
    """Interval of a rung's score; twice None where it has none."""
    found = ((rung.get("interval") or {}).get(split) or {}).get(score)
    return tuple(found) if found else (None, None)


def _reach(rung: dict[str, Any]) -> list[Any]:
    """All that is drawn of a rung."""
    ends = [rmse(rung, split) for split in SPLITS]
    return ends + [interval(rung, split)[1] for split in SPLITS]


def _colours(rungs: Sequence[dict[str, Any]]) -> list[str]:
    """Blue where an effect is added; a flexible residual on top of them adds none."""
    counts = [0, *(len(rung.get("effects") or ()) for rung in rungs)]
    found = [NAMED if counts[k + 1] > max(counts[: k + 1]) else NEUTRAL for k in range(len(rungs))]
    return [BASE, *found[1:]] if found and not counts[1] else found


def _whiskers(rungs: Sequence[dict[str, Any]], split: str) -> dict[str, Any]:
    """How far each interval reaches beyond the bar's end, both ways; 0 where there is none."""
    up, down = [], []
    for rung in rungs:
        value, (low, high) = rmse(rung, split), interval(rung, split)
        known = all(is_number(v) for v in (value, low, high))
        up.append(max(high - value, 0.0) if known else 0.0)
        down.append(max(value - low, 0.0) if known else 0.0)
    look = {"color": INK, "thickness": 1.2, "width": 3}
    return {"type": "data", "symmetric": False, "array": up, "arrayminus": down, **look}


def _line(figure: go.Figure, value: float | None, name: str, unit: str, dash: str) -> None:
    """A line from top to bottom, named in the legend with its value; none without a value."""
    if value is None or not is_number(value):
        return
    figure.add_shape(
        type="line",
        xref="x",
        yref="paper",
        x0=value,
        x1=value,
        y0=0,
        y1=1,
        name=f"{name}, {column([value], 2)[0]} {unit}",
        showlegend=True,
        line={"color": INK, "dash": dash, "width": 1.5},
    )
