"""How far model and measurement are apart, trial by trial, in numbers and in lines."""

from typing import Any

from spirob.report import overlay
from spirob.report.combinations import played, switchable
from spirob.report.data import ReportData
from spirob.report.figures import Plot
from spirob.report.regimes import driven
from spirob.report.sections import Section
from spirob.report.words import column, fixed, shown

METRICS = ("mae", "rmse", "r2")
POOR_FIT = 0.5  # R² below which a cell is marked


class Comparison(Section):
    """Errors of the base model, and its signals beside the measured ones."""

    order = 20
    title = "Comparison"
    template = "comparison.html.j2"

    def get_context(self, data: ReportData) -> dict[str, Any]:
        trials = data.compare["trials"]
        units = {
            channel: shown(_unit(trials, channel, si))[0] for channel, si in overlay.UNITS.items()
        }
        short, full = names(data.diagnosis)
        table, _ = switchable(data)
        signals = overlay.payload(table, short, driven(data.compare), played(table))
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
                overlay.frame(motors, full),
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


def _unit(trials: list[dict[str, Any]], channel: str, otherwise: str) -> str:
    for trial in trials:
        for motor in trial["motors"].values():
            if channel in motor:
                return motor[channel].get("unit", otherwise)
    return otherwise


def rows(trials: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """One row for each trial and motor, every column with its own number of decimals."""
    motors = [(t["name"], name, motor) for t in trials for name, motor in t["motors"].items()]
    found: list[dict[str, Any]] = [
        {"trial": trial, "motor": name, "driven": motor.get("driven", True), "cells": []}
        for trial, name, motor in motors
    ]
    for channel, si in overlay.UNITS.items():
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
    factors = [shown(entry.get("unit", si))[1] for entry in entries]
    scaled = [None if v is None else f * v for f, v in zip(factors, values, strict=True)]
    return [{"text": text, "poor": False} for text in column(scaled)]
