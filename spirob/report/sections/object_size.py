"""How well the size of a grasped cylinder is read from motor signals."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
import plotly.graph_objects as go

from spirob.report.data import ReportData
from spirob.report.figures import BASE, INK, NAMED, NEUTRAL, Plot, blank
from spirob.report.sections import Section
from spirob.report.words import fixed, is_number, percent

PAPER = {"simulation": {"mae": 1.12, "r2": 0.98}, "robot": {"mae": 3.95, "r2": 0.76}}
DOMAINS = {"simulation": "Simulation", "robot": "Robot"}
COLUMNS = (("mae", 2), ("rmse", 2), ("std", 2), ("r2", 3))
RESAMPLES, SEED, FEWEST = 2000, 0, 5


class ObjectSize(Section):
    """True against predicted diameter in simulation and on the robot, beside the paper's."""

    order = 60
    title = "Object size"
    template = "object_size.html.j2"

    def get_context(self, data: ReportData) -> dict[str, Any]:
        plot = None
        if data.predictions is not None and len(data.predictions):
            points = {
                str(domain): (rows["true_mm"].tolist(), rows["predicted_mm"].tolist())
                for domain, rows in data.predictions.dropna().groupby("domain", sort=True)
            }
            points = {domain: points[domain] for domain in sorted(points, reverse=True)}
            plot = Plot(
                "size",
                "Predicted over true diameter of the cylinder",
                size(points, half_widths(data)),
            )
        metrics = data.metrics.get("size")
        reason = data.absent.get("size_metrics") or data.absent.get("predictions", "")
        return {
            "plot": plot,
            "rows": rows(metrics, data.predictions) if metrics else [],
            "transfer": transfer_sentence(metrics) if metrics else "",
            "confidence": percent(interval(data).get("confidence")) if half_widths(data) else "",
            "reason": reason,
        }


def interval(data: ReportData) -> dict[str, Any]:
    """What the transfer stage says of the intervals; empty where they were not tested."""
    return (data.transfer or {}).get("interval") or {}


def half_widths(data: ReportData) -> dict[str, float]:
    """Half of each domain's interval [mm]; it is as wide for every size."""
    found = {domain: interval(data).get(domain) or {} for domain in DOMAINS}
    return {d: 5e2 * one["width"] for d, one in found.items() if is_number(one.get("width"))}


def rows(metrics: dict[str, Any], predictions: pd.DataFrame | None = None) -> list[dict[str, Any]]:
    """For each domain our figures [mm], with an interval of the MAE, and the paper's below."""
    found = []
    for domain, title in DOMAINS.items():
        for source, numbers in (("here", metrics.get(domain) or {}), ("paper", PAPER[domain])):
            cells = [_cell(numbers, key, decimals, source) for key, decimals in COLUMNS]
            span = mae_interval(predictions, domain) if source == "here" else ""
            found.append({"domain": title, "source": source, "cells": cells, "span": span})
    return found


def mae_interval(predictions: pd.DataFrame | None, domain: str) -> str:
    """95 % of the MAE [mm] over resampled objects; empty with too few to resample."""
    if predictions is None:
        return ""
    kept = predictions[predictions["domain"] == domain].dropna()
    errors = np.abs(kept["predicted_mm"].to_numpy(float) - kept["true_mm"].to_numpy(float))
    if len(errors) < FEWEST:
        return ""
    drawn = np.random.default_rng(SEED).choice(errors, (RESAMPLES, len(errors)))
    low, high = np.quantile(drawn.mean(axis=1), (0.025, 0.975))
    return f"{fixed(float(low), 2)} to {fixed(float(high), 2)}"


def transfer_sentence(metrics: dict[str, Any]) -> str:
    """How much the error grows from simulation to robot, here and in the paper."""
    ours = [(metrics.get(domain) or {}).get("mae") for domain in DOMAINS]
    if not (is_number(ours[0]) and is_number(ours[1]) and ours[0] > 0):
        return ""
    paper = PAPER["robot"]["mae"] / PAPER["simulation"]["mae"]
    return (
        f"Trained in simulation alone; on the robot the MAE is {fixed(ours[1] / ours[0], 1)} times "
        f"as large, in the paper {fixed(paper, 1)} times."
    )


def _cell(numbers: dict[str, Any], key: str, decimals: int, source: str) -> str:
    return fixed(numbers.get(key), 2 if source == "paper" else decimals)


def size(
    points: Mapping[str, tuple[Sequence[float], Sequence[float]]],
    half_widths: Mapping[str, float] | None = None,
) -> go.Figure:
    """Predicted over true diameter [mm] with the line of a perfect estimate.

    half_widths  of the interval [mm] that comes with each size, by domain
    """
    figure = blank(430)
    every = [value for pair in points.values() for values in pair for value in values]
    low, high = min(every) - 4, max(every) + 4
    figure.add_scatter(
        x=[low, high],
        y=[low, high],
        mode="lines",
        name="perfect",
        line={"color": NEUTRAL, "width": 1, "dash": "dot"},
        hoverinfo="skip",
    )
    looks = {"simulation": (NAMED, "circle-open"), "robot": (BASE, "diamond-open")}
    for domain, (true, predicted) in points.items():
        colour, symbol = looks.get(domain, (INK, "cross"))
        figure.add_scatter(
            x=list(true),
            y=list(predicted),
            mode="markers",
            name=domain,
            marker={"color": colour, "symbol": symbol, "size": 8, "line": {"width": 1.6}},
            error_y=_bar((half_widths or {}).get(domain), colour),
            hovertemplate="true %{x:.1f} mm, predicted %{y:.1f} mm<extra>" + domain + "</extra>",
        )
    figure.update_xaxes(
        title_text="true diameter [mm]", range=[low, high], constrain="domain", dtick=10
    )
    figure.update_yaxes(
        title_text="predicted diameter [mm]",
        range=[low, high],
        dtick=10,
        scaleanchor="x",
        constrain="domain",
    )
    return figure


def _bar(half: float | None, colour: str) -> dict[str, Any]:
    if half is None:
        return {"visible": False}
    return {"type": "constant", "value": half, "color": colour, "thickness": 0.7, "width": 2}
