"""The model run forward: measured and predicted motion, and errors beside guesses."""

from typing import Any

import numpy as np
import pandas as pd
import plotly.graph_objects as go

from spirob.report.data import ReportData
from spirob.report.figures import Plot
from spirob.report.sections import Section
from spirob.report.sections.overlay import Signals, models, stacked, thinned
from spirob.report.words import number, shown

NOT_ASKED = "The description asks for no motion (predict: motion or closed_loop)."
MOST_TRIALS = 3  # held-out ones first
LOGS = {"test": "held out", "train": "fitted"}
COLUMNS = (  # of the table: entry of a role, quantity, what it is called
    ("window", "position", "position, {horizon} [{position}]"),
    ("window", "speed", "speed, {horizon} [{speed}]"),
    ("whole", "position", "position, whole log [{position}]"),
    ("whole", "speed", "speed, whole log [{speed}]"),
    ("effort", "effort", "effort [{effort}]"),
)


class RigMotion(Section):
    """Figures of the motion over held-out logs, and the table of errors."""

    order = 22
    title = "Motion predicted"
    template = "rig_motion.html.j2"
    pages = ("rig",)

    @staticmethod
    def absent(context: dict[str, Any]) -> str:
        return str(context["absent"])

    def get_context(self, data: ReportData) -> dict[str, Any]:
        motion = data.diagnosis.get("motion")
        if motion is None or data.motion is None:
            why = (motion or {}).get("absent")
            return {"absent": f"The model was not run forward: {why}." if why else NOT_ASKED}
        named = " + ".join(e["name"].replace("_", " ") for e in data.diagnosis["effects"])
        plots = []
        groups = list(data.motion.groupby(["role", "trial"], sort=False))
        for k, ((role, trial), rows) in enumerate(groups[:MOST_TRIALS]):
            label = f"{trial}, {LOGS[str(role)]}"
            figure = motion_figure(rows, named, motion["unit"])
            plots.append((label, Plot(f"motion-{k}", f"Measured and predicted: {label}", figure)))
        return {"absent": "", "sentence": sentence(motion), "plots": plots, **table(motion)}


def sentence(motion: dict[str, Any]) -> str:
    """What is drawn and what the numbers are."""
    if any(rung["test"]["window"] for rung in motion["rungs"]):
        return (
            "The fitted models run under the measured effort. Above from the beginning of the log, "
            f"where an error grows; below what they miss over {motion['horizon']:g} s from the "
            "measured position and speed. Errors are RMS, with 95 % intervals; a model is worth "
            "what it is better than the guesses in the last rows."
        )
    return (
        "The fitted models run under the rig's controller, which follows the logged reference. "
        "Errors are RMS, with 95 % intervals. A controller hides in the motion what its effort "
        "shows."
    )


def table(motion: dict[str, Any]) -> dict[str, Any]:
    """Columns, and a row for each model or guess and set of logs."""
    units = {
        key: shown(motion[name]) for key, name in (("position", "unit"), ("speed", "speed_unit"))
    }
    units["effort"] = (motion["effort_unit"], 1.0)
    names = {key: unit for key, (unit, _) in units.items()}
    entries = [
        (" + ".join(["fitted numbers", *r["effects"]]).replace("_", " "), r)
        for r in motion["rungs"]
    ]
    entries += [(guess["name"], guess) for guess in motion["guesses"]]
    kept = [c for c in COLUMNS if any(_score(entry["test"], c) for _, entry in entries)]
    rows = [
        {
            "label": label,
            "logs": LOGS[role],
            "cells": [_cell(_score(entry[role], c), units[c[1]][1]) for c in kept],
        }
        for label, entry in entries
        for role in LOGS
    ]
    titles = [c[2].format(horizon=f"{motion['horizon']:g} s", **names) for c in kept]
    return {"columns": titles, "rows": rows}


def _score(role: dict[str, Any], column: tuple[str, str, str]) -> dict[str, Any] | None:
    entry = role[column[0]]
    return entry if entry is None or column[0] == "effort" else entry[column[1]]


def _cell(score: dict[str, Any] | None, factor: float) -> tuple[str, str]:
    if score is None:
        return number(None), ""
    low, high = score["interval"]
    ends = "" if low is None else f"{number(low * factor)} to {number(high * factor)}"
    return number(score["rmse"] * factor), ends


def motion_figure(rows: pd.DataFrame, named: str, unit: str) -> go.Figure:
    """Position above, what is missed of it below; `named` is empty where no effect was named."""
    kept = thinned(rows)
    unit, factor = shown(unit)
    measured = kept["position"].to_numpy(float)
    below = "window" if "base_position_window" in kept else "whole"
    signals: Signals = {"measured": (factor * measured, None)}
    for origin in models(named):
        missed = kept[f"{origin}_position_{below}"].to_numpy() - measured
        signals[origin] = (factor * kept[f"{origin}_position_whole"].to_numpy(), factor * missed)
    figure = stacked(kept["time"], signals, named, "position", unit)
    # a model that runs away would leave the measured motion as a flat line
    room = 0.5 * float(np.ptp(measured))
    ends = [factor * float(measured.min() - room), factor * float(measured.max() + room)]
    figure.update_layout(yaxis_range=ends)
    return figure
