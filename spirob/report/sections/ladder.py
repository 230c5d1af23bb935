"""Which effect it is: candidates, the steps from base model to noise, fitted numbers.

Of the ladder's two ceilings one is what a flexible model leaves, the other the noise of the sensor.
"""

import math
from collections.abc import Sequence
from typing import Any

import plotly.graph_objects as go

from spirob.report.data import ReportData
from spirob.report.figures import BASE, INK, NAMED, NEUTRAL, Plot, bars, wrap
from spirob.report.sections import Section
from spirob.report.sections.library import card
from spirob.report.words import EFFORT, column, fixed, interval, is_number, percent, unit_text

LABEL = (
    "Bars of the error of each model on held-out and on training trials with 95 % intervals, "
    "and lines where a flexible model and the sensor's noise are; section Ladder has the numbers"
)
SPLITS = {"heldout": "held-out trials", "train": "training trials (pale)"}
FAINT = 0.4  # of the training bars
LINE = 20  # pixels of a line of a label


def ladder_plot(rungs: Sequence[dict[str, Any]], noise_floor: float | None, unit: str) -> Plot:
    """The figure in its place on the page."""
    return Plot("steps", LABEL, ladder(rungs, noise_floor, unit))


def ladder(rungs: Sequence[dict[str, Any]], noise_floor: float | None, unit: str) -> go.Figure:
    """RMSE of each rung on held-out and training trials, with intervals and both ceilings."""
    labels = [wrap(rung["label"].replace("_", " ")) for rung in rungs]
    lines = max((label.count("<br>") + 1 for label in labels), default=1)
    figure = bars(150 + max(54, LINE * lines) * len(rungs), barmode="group", bargap=0.3)
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


def ends_of(rung: dict[str, Any], split: str, score: str = "rmse") -> tuple[Any, Any]:
    """Interval of a rung's score; twice None where it has none."""
    found = ((rung.get("interval") or {}).get(split) or {}).get(score)
    return tuple(found) if found else (None, None)


def _reach(rung: dict[str, Any]) -> list[Any]:
    """All that is drawn of a rung."""
    ends = [rmse(rung, split) for split in SPLITS]
    return ends + [ends_of(rung, split)[1] for split in SPLITS]


def _colours(rungs: Sequence[dict[str, Any]]) -> list[str]:
    """Blue where an effect is added; a flexible residual on top of them adds none."""
    counts = [0, *(len(rung.get("effects") or ()) for rung in rungs)]
    found = [NAMED if counts[k + 1] > max(counts[: k + 1]) else NEUTRAL for k in range(len(rungs))]
    return [BASE, *found[1:]] if found and not counts[1] else found


def _whiskers(rungs: Sequence[dict[str, Any]], split: str) -> dict[str, Any]:
    """How far each interval reaches beyond the bar's end, both ways; 0 where there is none."""
    up, down = [], []
    for rung in rungs:
        value, (low, high) = rmse(rung, split), ends_of(rung, split)
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


SPLIT_NAMES = {"train": "training", "validate": "validation", "heldout": "held-out"}
NONE = ("", "")
MOST = 6  # decimals of R²


def rows(ladder: Sequence[dict[str, Any]], noise_floor: float | None) -> list[dict[str, Any]]:
    """One row for each model and set of trials: a cell is a score and its interval.

    fresh  the first row of a model, which has its name;  span  rows of that model
    """
    kept = [(rung, [s for s in SPLIT_NAMES if rung.get(s)] or ["heldout"]) for rung in ladder]
    every = [(rung, split) for rung, splits in kept for split in splits]
    scores = {name: _texts(every, name) for name in ("mae", "rmse", "r2")}
    spans = {id(rung): len(splits) for rung, splits in kept}
    found = []
    for k, (rung, split) in enumerate(every):
        fresh = k == 0 or every[k - 1][0] is not rung
        found.append(
            {
                "label": rung["label"].replace("_", " "),
                "fresh": fresh,
                "span": spans[id(rung)],
                "trials": SPLIT_NAMES[split],
                "cells": [scores[name][k] for name in scores],
            }
        )
    return [*found, *_noise(noise_floor, every)]


def ceiling_sentence(ladder: Sequence[dict[str, Any]], share: float | None) -> str:
    """What a flexible model on top of the last rung could still explain; empty without one."""
    if not any(rung.get("ceiling") for rung in ladder) or not is_number(share):
        return ""
    return (
        "What could still be explained: a flexible model (boosted trees, which obey no law) "
        f"explains {percent(share)} of the squared error that the last model leaves, on training "
        "trials or parts of them that it was not fitted to. So much is there to be explained; a "
        "law, which needs less data, may explain more."
    )


def _texts(every: Sequence[tuple[dict[str, Any], str]], name: str) -> list[tuple[str, str]]:
    """Score and interval of each row, with the same number of decimals."""
    values = [(rung.get(split) or {}).get(name) for rung, split in every]
    ends = [ends_of(rung, split, name) for rung, split in every]
    if name == "r2":
        decimals = _decimals(values)
        texts = [[fixed(v, decimals) for v in three] for three in _threes(values, ends)]
    else:
        flat = column([v for three in _threes(values, ends) for v in three])
        texts = [flat[k : k + 3] for k in range(0, len(flat), 3)]
    known = [all(is_number(v) for v in pair) for pair in ends]
    return [(t[0], f"{t[1]} to {t[2]}" if k else "") for t, k in zip(texts, known, strict=True)]


def _threes(
    values: Sequence[float | None], ends: Sequence[tuple[Any, Any]]
) -> list[tuple[float | None, Any, Any]]:
    return [(v, *pair) for v, pair in zip(values, ends, strict=True)]


def _decimals(values: Sequence[float | None]) -> int:
    """Decimals of R² that show two digits of what the best model misses of 1."""
    missing = [1.0 - v for v in values if is_number(v) and v < 1.0]
    return min(max(3, 1 - math.floor(math.log10(min(missing)))), MOST) if missing else 3


def _noise(
    noise_floor: float | None, every: Sequence[tuple[dict[str, Any], str]]
) -> list[dict[str, Any]]:
    """The sensor's noise as a last row; it is an RMSE."""
    if not is_number(noise_floor):
        return []
    errors = [(rung.get(split) or {}).get("rmse") for rung, split in every]
    text = column([*errors, noise_floor])[-1]
    row = {"label": "sensor noise", "fresh": True, "span": 1, "trials": "training"}
    return [{**row, "cells": [NONE, (text, ""), NONE]}]


SHOWN = ("train", "left_out", "heldout")


class Ladder(Section):
    """The evidence behind the verdict, and what to measure next."""

    order = 40
    title = "Ladder and candidates"
    template = "ladder.html.j2"
    pages = ("arm", "rig")

    def get_context(self, data: ReportData) -> dict[str, Any]:
        diagnosis = data.diagnosis
        left = diagnosis.get("left") or {}
        chosen = {effect["name"] for effect in diagnosis["effects"]}
        return {
            "unit": diagnosis["unit"],
            "explanation": diagnosis.get("explanation", ""),
            "next_experiment": diagnosis.get("next_experiment", ""),
            "candidates": candidates(fitted(diagnosis), chosen),
            "screened": len(diagnosis["candidates"]) - len(fitted(diagnosis)),
            "rungs": rows(diagnosis["ladder"], diagnosis.get("noise_floor")),
            "ceiling": ceiling_sentence(diagnosis["ladder"], left.get("share")),
            "effects": [effect_entry(effect, declared(data)) for effect in diagnosis["effects"]],
        }


def declared(data: ReportData) -> dict[str, dict[str, Any]]:
    """What the library says of each named effect; a user's own file is not in it."""
    known = data.library
    titles = {effect["name"]: effect["title"] for effect in data.diagnosis["effects"]}
    named = {n: known[n] for n, title in titles.items() if n in known and known[n].title == title}
    return {name: card(effect) for name, effect in named.items()}


def fitted(diagnosis: dict[str, Any]) -> list[dict[str, Any]]:
    """The candidates that were fitted in full; the screening ended the others."""
    return [c for c in diagnosis["candidates"] if is_number(c.get("train_rmse"))]


def candidates(found: list[dict[str, Any]], chosen: set[str]) -> list[dict[str, Any]]:
    """Candidates as rows, most probable first."""
    found = sorted(found, key=lambda c: -(c.get("probability") or 0))
    errors = {key: column([c.get(f"{key}_rmse") for c in found]) for key in SHOWN}
    return [
        {
            "title": candidate["title"],
            "chosen": candidate["name"] in chosen,
            "share": candidate["probability"] if is_number(candidate.get("probability")) else 0,
            "probability": percent(candidate.get("probability")),
            "errors": [errors[key][k] for key in SHOWN],
            "gain": percent(candidate.get("screen_gain")),
        }
        for k, candidate in enumerate(found)
    ]


def effect_entry(effect: dict[str, Any], cards: dict[str, dict[str, Any]]) -> dict[str, Any]:
    """A named effect with its law, its fitted numbers and what it cannot be told from."""
    about = cards.get(effect["name"])
    symbols = {number["name"]: number["symbol"] for number in about["numbers"]} if about else {}
    return {
        "title": effect["title"],
        "name": effect["name"],
        "about": about,
        "probability": percent(effect.get("probability")),
        "equivalents": effect.get("equivalents") or [],
        "parameters": [
            {
                "name": name.replace("_", " "),
                "symbol": symbols.get(name, ""),
                "unit": unit_text(fitted["unit"]),
                "texts": interval(fitted["value"], fitted.get("low"), fitted.get("high")),
            }
            for name, fitted in effect.get("parameters", {}).items()
        ],
    }
