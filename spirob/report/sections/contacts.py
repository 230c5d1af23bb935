"""How often, how soon and how wrongly contacts are told, along the arm and by how it presses."""

from collections.abc import Iterable, Mapping, Sequence
from itertools import product
from typing import Any

import plotly.graph_objects as go

from spirob.report.data import ReportData
from spirob.report.figures import BASE, INK, NAMED, Plot, blank
from spirob.report.sections import Section
from spirob.report.words import MISSING, fixed, percent

SIGNALS = {"current": "raw current", "filtered": "100-sample mean"}
DOMAINS = {"simulation": ("simulation", NAMED), "robot": ("robot", BASE)}
THRESHOLDS = {"paper": ("the paper's", "dot", "diamond"), "tuned": ("tuned", "solid", "star")}
WITHIN = "20"  # mm of further travel that a hit may take
DECADES = (0.01, 0.1, 1.0, 10.0, 100.0)  # false alarms a minute that have a label
APART = (-0.9, -0.3, 0.3, 0.9)  # % of the length, so that bars do not cover each other
HITS = f"told within {WITHIN} mm of travel"


class Contacts(Section):
    """The detector with the paper's thresholds and with tuned ones, in simulation and on robot."""

    order = 57
    title = "Contact detector"
    template = "contacts.html.j2"

    def get_context(self, data: ReportData) -> dict[str, Any]:
        found = data.contacts or {}
        signals = {key: found[key] for key in SIGNALS if key in found}
        return {
            "counts": _counts(signals),
            "scales": {SIGNALS[key]: fixed(one["tuned_scale"], 2) for key, one in signals.items()},
            "rows": [row for key, one in signals.items() for row in rows(SIGNALS[key], one)],
            "curves": [_curve(key, one) for key, one in signals.items()],
            "along": [pair for key, one in signals.items() for pair in _along(key, one)],
            "tables": [_table(key, one) for key, one in signals.items() if _in_parts(one)],
            "columns": [f"{DOMAINS[d][0]}, {THRESHOLDS[t][0]}" for d, t in _sides()],
            "reason": data.absent.get("contacts", ""),
        }


def rows(name: str, signal: Mapping[str, Any]) -> list[dict[str, Any]]:
    """A row for each domain and thresholds: shares told, delays and false alarms."""
    out = []
    for rules, (how, *_) in THRESHOLDS.items():
        for domain, (where, _) in DOMAINS.items():
            one = signal[domain][rules]
            median, late = one["delay"] or (None, None)
            cells = [percent(one["ever"]), *(percent(share) for share in one["hits"].values())]
            cells += [fixed(median, 0), fixed(late, 0), fixed(one["alarms"], 2)]
            out.append({"signal": name, "thresholds": how, "where": where, "cells": cells})
    return out


def _counts(signals: Mapping[str, Any]) -> dict[str, str]:
    if not signals:
        return {}
    one = next(iter(signals.values()))
    return {domain: fixed(one[domain]["paper"]["contacts"], 0) for domain in DOMAINS}


def _curve(key: str, signal: Mapping[str, Any]) -> Plot:
    label = f"{SIGNALS[key].capitalize()}: contacts told in time, over false alarms"
    return Plot(f"contacts-roc-{key}", label, roc(signal))


def _along(key: str, signal: Mapping[str, Any]) -> list[Plot]:
    if not _in_parts(signal):
        return []
    hits, delay = hits_along(signal), delay_along(signal)
    name = SIGNALS[key].capitalize()
    return [
        Plot(f"contacts-hits-{key}", f"{name}: contacts told in time, along the arm", hits),
        Plot(f"contacts-delay-{key}", f"{name}: delay of the decision, along the arm", delay),
    ]


def _in_parts(signal: Mapping[str, Any]) -> bool:
    return all("by_place" in signal[domain][rules] for domain, rules in _sides())


def _sides() -> list[tuple[str, str]]:
    return [(domain, rules) for domain in DOMAINS for rules in THRESHOLDS]


def _table(key: str, signal: Mapping[str, Any]) -> dict[str, Any]:
    """Hits and delays by gap and by motion, a column for each domain and thresholds."""
    found = {}
    for cut, said in (("by_gap", _gap), ("by_motion", _motion)):
        sides = [signal[domain][rules][cut] for domain, rules in _sides()]
        for parts in zip(*sides, strict=True):
            found[said(parts[0])] = [_cell(part) for part in parts]
    return {"signal": SIGNALS[key], "lines": found}


def _gap(part: Mapping[str, Any]) -> str:
    return f"gap of {fixed(1e3 * part['gap'], 0)} mm"


def _motion(part: Mapping[str, Any]) -> str:
    return f"{fixed(1e3 * part['speed'], 0)} mm/s against {fixed(part['load'], 2)} A"


def _cell(part: Mapping[str, Any]) -> str:
    if not part["contacts"]:
        return MISSING
    delay: Sequence[float] = part["delay"] or ()
    share = f"{percent(part['hits'][WITHIN])} of {fixed(part['contacts'], 0)}"
    return f"{share}, {fixed(delay[0], 0)} ms" if delay else share


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
