"""What the residual showed of an effect, against its fitted law, in numbers and figures.

The model that holds the effect was played with it and, all other numbers as fitted, without it:

    shown = measured − without,     law = with − without,

both in current [A] on trials that no fit has seen.  A law that is right has shown = law + noise.
"""

from collections.abc import Collection
from dataclasses import dataclass

import numpy as np
import pandas as pd
import plotly.graph_objects as go

from spirob.effects.effect import Effect
from spirob.report.embed import stride
from spirob.report.figures import INK, NAMED, NEUTRAL, blank
from spirob.report.words import shown as unit_shown

KEYS = ["trial", "motor", "time"]
TURNING = ("speed", "velocity", "sliding")
CURRENTS = ("command.current", "sensing.current", "sensing.report")  # ports
LOADING = ("current", "command", "tension", "load_torque", "power")
PLACING = ("angle", "displacement", "stretch", "stiffness", "weight")


@dataclass(frozen=True)
class Against:
    """A measured signal that a law is drawn over: its channel, its name and its unit."""

    channel: str
    title: str


SPEED = Against("velocity", "speed of the tendon [m/s]")
LOAD = Against("current", "motor current [A]")
PLACE = Against("displacement", "wound-in length [m]")
TIME = Against("time", "time since the trial began [s]")


@dataclass(frozen=True)
class Law:
    """Samples of driven motors: the signal it is drawn over, what was shown and the law.

    effort, unit, factor  what both are called, the unit that they are drawn in, from their own
    """

    against: Against
    x: np.ndarray
    shown: np.ndarray
    law: np.ndarray
    effort: str = "current"
    unit: str = "mA"
    factor: float = 1e3

    @property
    def accounted(self) -> float:
        """Share of the squared effort shown that the law takes away; negative if it adds."""
        return 1.0 - float(np.mean((self.shown - self.law) ** 2) / np.mean(self.shown**2))


def against(effect: type[Effect] | None) -> Against:
    """The measured signal nearest to what the law depends on, by the first signal it reads."""
    reads = list(effect.reads.values()) if effect is not None else []
    for signal in reads:
        own = signal.partition(".")[2]
        if any(word in own for word in LOADING):
            return LOAD
        if any(word in own for word in TURNING) and own != "rest_speed":
            return SPEED
        if any(word in own for word in PLACING):
            return PLACE
    if effect is not None and effect.port in CURRENTS:
        return LOAD
    return TIME


def law(
    played: pd.DataFrame,
    overlay: pd.DataFrame,
    driven: Collection[tuple[str, str]],
    effect: type[Effect] | None,
) -> Law | None:
    """One effect's samples, from its rows of `laws.parquet`; None where no motor was driven."""
    wide = played.merge(overlay, on=KEYS, how="inner")
    pairs = pd.Series(list(zip(wide["trial"].astype(str), wide["motor"].astype(str), strict=True)))
    wide = wide[pairs.isin(list(driven)).to_numpy()]
    over = against(effect)
    column = "time" if over is TIME else f"measured_{over.channel}"
    without = wide["without_current"].to_numpy(float)
    shown = wide["measured_current"].to_numpy(float) - without
    found = wide["with_current"].to_numpy(float) - without
    if not len(wide) or not np.any(shown):
        return None
    return Law(over, wide[column].to_numpy(float), shown, found)


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
