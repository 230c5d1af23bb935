"""Each effect over the data: its fitted law, and what would tell it from its rivals.

The model that holds the effect was played with it and, all other numbers as fitted, without it:

    shown = measured − without,     law = with − without,

both in current [A] on trials that no fit has seen.  A law that is right has shown = law + noise.
"""

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
import plotly.graph_objects as go

from spirob.effects import all_effects
from spirob.effects.effect import Effect
from spirob.report.data import ReportData
from spirob.report.figures import INK, NAMED, NEUTRAL, Plot, blank, driven, stride
from spirob.report.sections import Section
from spirob.report.sections.switches import names
from spirob.report.words import column, is_number, percent
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
    figure.add_scatter(**_dots(x[::step], seen[::step], "residual without it", NEUTRAL))
    figure.add_scatter(**_dots(x[::step], said[::step], "fitted law", NAMED))
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
    figure.add_scatter(**_dots(said[::step], seen[::step], "samples of unseen trials", NAMED))
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


def _dots(x: np.ndarray, y: np.ndarray, name: str, colour: str) -> dict:
    return {
        "x": _rounded(x),
        "y": _rounded(y),
        "mode": "markers",
        "name": name,
        "marker": {"color": colour, "size": 4, "opacity": 0.55},
        "hoverinfo": "skip",
    }


def _rounded(values: np.ndarray) -> list[float]:
    return [float(f"{v:.4g}") for v in values]


class Laws(Section):
    """For each named effect, or the leading candidates: law against residual, and the rivals."""

    order = 42
    title = "Effects over the data"
    template = "laws.html.j2"

    def get_context(self, data: ReportData) -> dict[str, Any]:
        if data.laws is None:
            return {"effects": [], "named": False, "reason": data.absent["laws"]}
        known, places = all_effects(), driven(data.compare)
        shown = []
        for label, played in data.laws.groupby("effect", sort=False, observed=True):
            name = str(label)
            if found := law(played, data.overlay, places, known.get(name)):
                title = names(data, [name])[name]
                shown.append(entry(name, title, found, rivals(name, data)))
        return {
            "effects": shown,
            "named": bool(data.diagnosis["effects"]),
            "reason": "No motor was driven in a trial that no fit has seen.",
        }


def entry(name: str, title: str, found: Law, rivals: Sequence[dict[str, str]]) -> dict[str, Any]:
    """Texts and figures of one effect."""
    plots = law_plots(name, title, found)
    return {"title": title, "sentence": sentence(found), "rivals": rivals, "plots": plots}


def law_plots(name: str, title: str, found: Law) -> list[Plot]:
    """The two figures of an effect: over the signal that it depends on, and over its own law."""
    over = found.against.title.partition(" [")[0]
    return [
        Plot(
            f"law-{name}",
            f"Residual and fitted law of {title} over {over}",
            over_signal(found),
        ),
        Plot(
            f"law-{name}-itself",
            f"Residual over the fitted law of {title}",
            against_itself(found),
        ),
    ]


def sentence(found: Law) -> str:
    """How much of what the residual showed the law accounts for."""
    share = found.accounted
    if share <= 0:
        return "The law takes nothing off the squared residual of the trials that no fit has seen."
    return (
        f"The law accounts for {percent(share)} of the squared residual that is left without it, "
        "on trials that no fit has seen."
    )


def rivals(name: str, data: ReportData) -> list[dict[str, str]]:
    """The other candidates: what each leaves, and the experiment that would tell them apart."""
    known = all_effects()
    chosen = {effect["name"] for effect in data.diagnosis["effects"]} | {name}
    others = [
        c for c in data.diagnosis["candidates"] if c["name"] not in chosen and is_number(_milli(c))
    ]
    errors = column([_milli(c) for c in others])
    found = []
    for other, error in zip(others, errors, strict=True):
        rival = other["name"]
        ways = [
            known[a].tell_apart[b]
            for a, b in ((name, rival), (rival, name))
            if a in known and b in known[a].tell_apart
        ]
        test = ways[0] if ways else "the library holds no experiment for these two"
        found.append({"title": other["title"], "left": f"{error} mA", "test": test})
    return found


def _milli(candidate: dict[str, Any]) -> float | None:
    value = candidate.get("left_out_rmse")
    return 1e3 * value if is_number(value) else None


ABSENT = "Laws are drawn where an effect is named."


class RigLaws(Section):
    """For each named effect: law against residual over the signal that it depends on."""

    order = 42
    title = "Effects over the data"
    template = "laws.html.j2"
    pages = ("rig",)

    def get_context(self, data: ReportData) -> dict[str, Any]:
        named = {effect["name"]: effect["title"] for effect in data.diagnosis["effects"]}
        shown = []
        if data.laws is not None:
            for name, rows in data.laws.groupby("effect", sort=False):
                if name in named and rows["shown"].any():
                    found = law_of(rows, data.diagnosis)
                    shown.append(entry(str(name), named[str(name)], found, []))
        return {"effects": shown, "named": True, "reason": ABSENT}


def law_of(rows: pd.DataFrame, diagnosis: dict[str, Any]) -> Law:
    """The samples of one effect, over the signal of the rig nearest to what it depends on."""
    axis, unit = rows["axis"].iloc[0], diagnosis["unit"]
    over = {
        SPEED: ("velocity", Against("velocity", f"speed [{axis}/s]")),
        PLACE: ("position", Against("position", f"position [{axis}]")),
        LOAD: ("effort", Against("effort", f"{diagnosis['effort']} [{unit}]")),
        TIME: ("time", Against("time", "time since the log began [s]")),
    }
    column, shown_over = over[against(all_effects().get(str(rows["effect"].iloc[0])))]
    x, seen, law = (rows[name].to_numpy(float) for name in (column, "shown", "law"))
    return Law(shown_over, x, seen, law, diagnosis["effort"], unit, 1.0)
