"""How far model and measurement are apart, trial by trial, in numbers and in lines.

Every trial is on the page, one is drawn.  Traces say in `meta` which signal they show and, for a
residual, which one is taken from it; `assets/overlay.js` fills them.
"""

from collections.abc import Collection, Sequence
from typing import Any

import numpy as np
import pandas as pd
import plotly.graph_objects as go

from spirob.report.data import ReportData
from spirob.report.figures import (
    BASE,
    INK,
    MEASURED,
    NAMED,
    Plot,
    blank,
    driven,
    pack,
    spans,
    stride,
)
from spirob.report.sections import Section
from spirob.report.sections.switches import played, switchable
from spirob.report.words import column, fixed, shown

ROLES = ("heldout", "validate", "train")  # what nothing has seen comes first
UNITS = {"current": "A", "displacement": "m", "velocity": "m/s"}
MOST_SAMPLES = 2000  # of one signal; more than a laptop has pixels
BUDGET = 2_000_000  # bytes of base64 for all trials together
BASE64 = 4 / 3  # bytes for one
SIGNAL_HEIGHT, RESIDUAL_HEIGHT, GAP = 190, 105, 26  # pixels
LOOKS = {
    "measured": {"color": MEASURED, "width": 2},
    "base": {"color": BASE, "width": 1.4, "dash": "4px,2px"},
    "named": {"color": NAMED, "width": 1.4},
}


def payload(
    overlay: pd.DataFrame,
    best: str,
    driven: Collection[tuple[str, str]] = (),
    played: Sequence[str] = (),
) -> dict[str, Any]:
    """Every trial, held-out trials first: packed signals in the units they are shown in.

    best    short name of the model beside the base model, for the phrase with the errors
    driven  trial and motor wherever the regimes of the atlas can be marked
    played  combinations of effects whose responses are in columns COMBINATION_CHANNEL
    """
    groups = dict(list(overlay.groupby(["trial", "motor"], sort=False)))
    sample = BASE64 * (2 + len(UNITS) * (2 * len(LOOKS) + len(played)))  # bytes
    most = int(min(MOST_SAMPLES, BUDGET / (sample * max(len(groups), 1))))
    trials: dict[str, dict[str, Any]] = {}
    for (trial, motor), rows in groups.items():
        entry = trials.setdefault(
            str(trial), {"name": str(trial), "role": str(rows["role"].iloc[0]), "motors": {}}
        )
        about = _motor(rows.sort_values("time"), most, best, played)
        known = (str(trial), str(motor)) in driven
        about["regimes"] = spans(rows, str(trial), str(motor)) if known else {}
        entry["motors"][str(motor)] = about
    ordered = sorted(trials.values(), key=lambda entry: ROLES.index(entry["role"]))
    titles = {channel: f"[{shown(unit)[0]}]" for channel, unit in UNITS.items()}
    return {"trials": ordered, "units": titles}


def _motor(rows: pd.DataFrame, most: int, best: str, played: Sequence[str]) -> dict[str, Any]:
    """Signals of one motor; those of combinations as what they change of the base model."""
    step = stride(len(rows), most)
    kept = rows.iloc[::step]
    signals = {"time": pack(kept["time"].to_numpy())}
    errors = {}
    for channel, unit in UNITS.items():
        name, factor = shown(unit)
        values = {
            f"{origin}_{channel}": factor * kept[f"{origin}_{channel}"].to_numpy(float)
            for origin in (*LOOKS, *played)
        }
        for origin in LOOKS:
            signals[f"{origin}_{channel}"] = pack(values[f"{origin}_{channel}"])
        for combination in played:
            change = values[f"{combination}_{channel}"] - values[f"base_{channel}"]
            signals[f"{combination}_{channel}"] = pack(change, coarse=True)
        errors[channel] = _errors(rows, channel, factor, name, best)
    return {"signals": {k: v for k, v in signals.items() if v is not None}, "errors": errors}


def _errors(rows: pd.DataFrame, channel: str, factor: float, unit: str, best: str) -> str:
    """RMSE of both models over all samples, not only those drawn, as a phrase."""
    measured = rows[f"measured_{channel}"].to_numpy(float)
    found = []
    for origin, name in (("base", "base"), ("named", best)):
        difference = factor * (measured - rows[f"{origin}_{channel}"].to_numpy(float))
        difference = difference[np.isfinite(difference)]
        if difference.size:
            found.append((name, float(np.sqrt(np.mean(difference**2)))))
    texts = column([value for _, value in found])
    parts = [f"{name} {text} {unit}" for (name, _), text in zip(found, texts, strict=True)]
    return "residual RMSE: " + ", ".join(parts) if parts else "not recorded"


def frame(motors: list[str], named: str) -> go.Figure:
    """For each motor a panel of signals and, under it, one of residuals; no data yet.

    named  how the model with the named effect is called in the legend
    """
    total = len(motors) * (SIGNAL_HEIGHT + RESIDUAL_HEIGHT + 2 * GAP)
    figure = blank(
        total + 100, hovermode="x", dragmode="zoom", margin={"l": 8, "r": 12, "t": 58, "b": 8}
    )
    names = {"measured": "measured", "base": "base model", "named": named}
    top = 1.0
    for row, motor in enumerate(motors):
        signal, residual = 2 * row + 1, 2 * row + 2
        for origin, look in LOOKS.items():
            figure.add_trace(_trace(motor, origin, names[origin], look, signal, row == 0))
        for origin in ("base", "named"):
            trace = _trace(motor, origin, names[origin], LOOKS[origin], residual, False)
            trace.meta["minus"] = "measured"
            figure.add_trace(trace)
        top = _place(figure, signal, top, SIGNAL_HEIGHT / total, GAP / total)
        top = _place(figure, residual, top, RESIDUAL_HEIGHT / total, GAP / total)
    last = f"y{2 * len(motors)}" if motors else "y"
    figure.update_layout(legend={"y": 1 + GAP / total})
    figure.update_layout(xaxis={"title": {"text": "time [s]"}, "anchor": last, "zeroline": False})
    return figure


def _trace(motor: str, origin: str, name: str, look: dict, row: int, legend: bool) -> go.Scatter:
    return go.Scatter(
        name=name,
        mode="lines",
        line=look,
        legendgroup=origin,
        showlegend=legend,
        xaxis="x",
        yaxis="y" if row == 1 else f"y{row}",
        meta={"motor": motor, "origin": origin},
        hovertemplate="%{y:.4g}",
    )


def _place(figure: go.Figure, row: int, top: float, height: float, gap: float) -> float:
    """Give panel `row` its strip below `top` and an empty title; returns the next strip's top."""
    bottom = max(top - height, 0.0)
    axis = "yaxis" if row == 1 else f"yaxis{row}"
    figure.update_layout({axis: {"domain": [bottom, top], "nticks": 5}})
    figure.add_annotation(
        text="",
        x=0,
        y=top,
        xref="paper",
        yref="paper",
        xanchor="left",
        yanchor="bottom",
        showarrow=False,
        font={"size": 12, "color": INK},
    )
    return bottom - gap


METRICS = ("mae", "rmse", "r2")
POOR_FIT = 0.5  # R² below which a cell is marked


class Comparison(Section):
    """Errors of the base model, and its signals beside the measured ones."""

    order = 20
    title = "Comparison"
    template = "comparison.html.j2"

    def get_context(self, data: ReportData) -> dict[str, Any]:
        trials = data.compare["trials"]
        units = {channel: shown(si)[0] for channel, si in UNITS.items()}
        short, full = names(data.diagnosis)
        table, _ = switchable(data)
        signals = payload(table, short, driven(data.compare), played(table))
        motors = list(dict.fromkeys(data.overlay["motor"].astype(str)))
        return {
            "units": units,
            "heldout": rows([t for t in trials if t.get("role") != "train"]),
            "train": rows([t for t in trials if t.get("role") == "train"]),
            "poor_fit": POOR_FIT,
            "signals": signals,
            "regimes": marked(data.diagnosis["atlas"], signals["trials"]),
            "overlay": Plot(
                "overlay",
                "Measured and modelled signals of the chosen trial, residuals under them",
                frame(motors, full),
            ),
        }


def marked(regimes: list[dict[str, Any]], trials: list[dict[str, Any]]) -> list[str]:
    """Regimes of the atlas that hold in some of these trials: the others have nothing to mark."""
    motors = [motor["regimes"] for trial in trials for motor in trial["motors"].values()]
    return [r["regime"] for r in regimes if any(spans.get(r["regime"]) for spans in motors)]


def names(diagnosis: dict[str, Any]) -> tuple[str, str]:
    """Short and full name of the model that is shown beside the base model."""
    effects = [effect["title"] for effect in diagnosis["effects"]]
    if diagnosis["verdict"] == "named" and effects:
        return "with effect", "with " + " and ".join(effects)
    return "best", "best model"


def rows(trials: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """One row for each trial and motor, every column with its own number of decimals."""
    motors = [(t["name"], name, motor) for t in trials for name, motor in t["motors"].items()]
    found: list[dict[str, Any]] = [
        {"trial": trial, "motor": name, "driven": motor.get("driven", True), "cells": []}
        for trial, name, motor in motors
    ]
    for channel, si in UNITS.items():
        entries = [motor.get(channel, {}) for _, _, motor in motors]
        for metric in METRICS:
            for row, cell in zip(found, _cells(entries, metric, si), strict=True):
                row["cells"].append(cell)
    for row, (_, _, motor) in zip(found, motors, strict=True):
        row["cells"].append({"text": fixed(motor.get("delay_ms"), 1), "poor": False})
    return found


def _cells(entries: list[dict[str, Any]], metric: str, si: str) -> list[dict[str, Any]]:
    values = [entry.get(metric) for entry in entries]
    if metric == "r2":
        return [
            {"text": fixed(v, 3 if v is None or abs(v) < 10 else 0), "poor": (v or 0) < POOR_FIT}
            if v is not None
            else {"text": fixed(None, 0), "poor": False}
            for v in values
        ]
    scaled = [None if v is None else shown(si)[1] * v for v in values]
    return [{"text": text, "poor": False} for text in column(scaled)]
