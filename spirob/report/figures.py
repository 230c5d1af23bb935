"""The figures, as plotly describes them, the signals in them, and the moments of the atlas.

Colours are names that the page's style resolves.  Horizontal bars throughout: labels are read
without turning the head, on a phone too.

Signals are packed as 16-bit integers in base64: a quarter of the size of a double, finer than a
pixel.  A packed signal is {"low", "step", "data"}; sample = low + step·(integer + 32767), and the
integer -32768 stands for a missing sample.  A small change of another signal does with 8 bits,
"coarse": low + step·(integer + 127), -128 missing.  `assets/packing.js` is the other half.

The atlas is of the training trials; the overlay shows others.  Its signals are what the regimes are
defined on, so the same definitions mark the same situations there.
"""

import base64
import json
import textwrap
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
import plotly.graph_objects as go

from spirob.diagnosis.atlas import masks_of
from spirob.identify.problem import Stretch
from spirob.identify.residual import STILL
from spirob.report.words import percent

MEASURED, BASE, NAMED = "var(--measured)", "var(--base)", "var(--named)"
NEUTRAL, GRID, INK = "var(--neutral)", "var(--grid)", "var(--ink)"
CLEAR = "rgba(0,0,0,0)"
LABEL_WIDTH = 22  # characters before a label takes a second line
Spans = dict[str, list[list[float]]]  # regime -> from, to [s]


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


def wrap(label: str, width: int = LABEL_WIDTH) -> str:
    """A label over several lines."""
    return "<br>".join(textwrap.wrap(label, width)) or label


def bars(height: int, **layout: Any) -> go.Figure:
    """A figure for horizontal bars, the first on top."""
    figure = blank(height, **{"bargap": 0.35, **layout})
    figure.update_yaxes(autorange="reversed", showgrid=False, ticks="", ticklabelstandoff=6)
    figure.update_xaxes(rangemode="tozero")
    return figure


FINE, COARSE = np.dtype("<i2"), np.dtype("i1")


def pack(signal: np.ndarray, coarse: bool = False) -> dict[str, Any] | None:
    """Pack one signal; None when it holds no finite sample."""
    signal = np.asarray(signal, float)
    finite = np.isfinite(signal)
    if not finite.any():
        return None
    kind = COARSE if coarse else FINE
    most = int(np.iinfo(kind).max)
    low, high = float(signal[finite].min()), float(signal[finite].max())
    step = (high - low) / (2 * most) or 1.0
    level = np.full(signal.shape, -most - 1, kind)
    level[finite] = np.round((signal[finite] - low) / step) - most
    data = base64.b64encode(level.tobytes()).decode("ascii")
    return {"low": low, "step": step, "data": data} | ({"coarse": True} if coarse else {})


def unpack(packed: dict[str, Any]) -> np.ndarray:
    """The signal again, to within half a step."""
    kind = COARSE if packed.get("coarse") else FINE
    most = np.iinfo(kind).max
    level = np.frombuffer(base64.b64decode(packed["data"]), kind).astype(float)
    level[level == -most - 1] = np.nan
    return np.asarray(packed["low"] + packed["step"] * (level + most))


def stride(samples: int, most: int) -> int:
    """Keep every so-many-th sample so that at most `most` are left."""
    return max(1, -(-samples // most))


def spans(rows: pd.DataFrame, trial: str, motor: str) -> Spans:
    """Times of each regime for one motor of one trial, from its measured signals (SI)."""
    rows = rows.sort_values("time")
    seconds = rows["time"].to_numpy(float)
    return {name: _runs(seconds, mask) for name, mask in masks(rows, trial, motor).items()}


def masks(rows: pd.DataFrame, trial: str, motor: str) -> dict[str, np.ndarray]:
    """Samples of each regime, for rows in the order of time; none where a signal has gaps."""
    seconds, position, velocity, current = (
        rows[name].to_numpy(float)
        for name in ("time", "measured_displacement", "measured_velocity", "measured_current")
    )
    if len(rows) < 2 or not np.isfinite([position, velocity, current]).all():
        return {}
    piece = Stretch(
        trial,
        f"{motor} motor",
        seconds,
        position,
        velocity,
        current,
        STILL,
        "winding in",
        "paying out",
    )
    return masks_of(piece)


def driven(compare: dict[str, Any]) -> set[tuple[str, str]]:
    """Trial and motor wherever the motor was not held at a commanded current."""
    return {
        (trial["name"], name)
        for trial in compare.get("trials", ())
        for name, motor in trial["motors"].items()
        if motor.get("driven", True)
    }


def _runs(seconds: np.ndarray, mask: np.ndarray) -> list[list[float]]:
    """First and last time of each run of true samples."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], mask.astype(np.int8), [0]])))
    pairs = edges.reshape(-1, 2)
    return [[round(float(seconds[a]), 3), round(float(seconds[b - 1]), 3)] for a, b in pairs]


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


def regimes(errors: Mapping[str, float], effort: str, unit: str) -> go.Figure:
    """RMSE of the worst regimes [unit] for the base model, and room for that of another."""
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
            hovertemplate=f"%{{x:.3g}} {unit}<extra>%{{y}}, {name}</extra>",
        )
    figure.update_xaxes(
        title_text=f"RMSE of {effort} [{unit}]", range=[0, 1.05 * max(errors.values())]
    )
    return figure
