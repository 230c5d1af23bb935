"""The figures of a law over its data: against the signal it depends on, and against itself."""

import numpy as np
import plotly.graph_objects as go

from spirob.report.figures import INK, NAMED, NEUTRAL, blank
from spirob.report.laws import Law
from spirob.report.numbers import shown as unit_shown
from spirob.report.packing import stride

MOST = 1200  # dots of one kind
BINS = 20  # along the signal, as many samples in each
HEIGHT = 360


def over_signal(law: Law) -> go.Figure:
    """Dots of both over the signal, and the median of what was shown, bin by bin."""
    unit = law.against.title.rpartition("[")[2].rstrip("]")
    name, factor = unit_shown(unit) if unit != "s" else (unit, 1.0)
    x = factor * law.x
    step = stride(len(x), MOST)
    figure = blank(HEIGHT, legend_itemsizing="constant")
    seen, said = law.factor * law.shown, law.factor * law.law
    figure.add_scatter(**_dots(x[::step], seen[::step], "residual without it", NEUTRAL, 4))
    figure.add_scatter(**_dots(x[::step], said[::step], "fitted law", NAMED, 4))
    middle, median = medians(x, seen)
    figure.add_scatter(
        x=_rounded(middle),
        y=_rounded(median),
        mode="markers",
        name="median of the residual",
        marker={"color": INK, "size": 9, "symbol": "diamond-open", "line": {"width": 2}},
        hovertemplate=f"%{{y:.3g}} {law.unit} at %{{x:.3g}}<extra>median</extra>",
    )
    figure.update_xaxes(title_text=law.against.title.replace(f"[{unit}]", f"[{name}]"))
    figure.update_yaxes(title_text=f"{law.effort} [{law.unit}]")
    return figure


def against_itself(law: Law) -> go.Figure:
    """What was shown over what the law says, with the line on which both are equal."""
    step = stride(len(law.law), MOST)
    seen, said = law.factor * law.shown, law.factor * law.law
    low, high = float(said.min()), float(said.max())
    figure = blank(HEIGHT, legend_itemsizing="constant")
    figure.add_scatter(**_dots(said[::step], seen[::step], "samples of unseen trials", NAMED, 4))
    figure.add_scatter(
        x=[low, high],
        y=[low, high],
        mode="lines",
        name="law = residual",
        line={"color": INK, "width": 1.5, "dash": "dot"},
        hoverinfo="skip",
    )
    figure.update_xaxes(title_text=f"fitted law [{law.unit}]")
    figure.update_yaxes(title_text=f"residual without it [{law.unit}]")
    return figure


def medians(x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Medians of x and y in bins along x that hold equally many samples."""
    order = np.array_split(np.argsort(x, kind="stable"), min(BINS, len(x)))
    return np.array([np.median(x[o]) for o in order]), np.array([np.median(y[o]) for o in order])


def _dots(x: np.ndarray, y: np.ndarray, name: str, colour: str, size: int) -> dict:
    return {
        "x": _rounded(x),
        "y": _rounded(y),
        "mode": "markers",
        "name": name,
        "marker": {"color": colour, "size": size, "opacity": 0.55},
        "hoverinfo": "skip",
    }


def _rounded(values: np.ndarray) -> list[float]:
    return [float(f"{v:.4g}") for v in values]
