"""How late the loop's cycles were when the trials were recorded."""

from collections.abc import Mapping
from itertools import pairwise
from typing import Any

import plotly.graph_objects as go

from spirob.report.data import ReportData
from spirob.report.figures import NAMED, Plot, bars
from spirob.report.sections import Section
from spirob.report.words import column, fixed


class Loop(Section):
    """Lateness of each trial, its histogram, and what priority the loop had."""

    order = 85
    title = "Control cycle"
    template = "loop.html.j2"

    def get_context(self, data: ReportData) -> dict[str, Any]:
        loops = data.loops
        plot = None
        if loops:
            label = "Cycles of all trials by how late they ended"
            plot = Plot("lateness", label, histogram(loops))
        return {
            "rows": rows(loops),
            "priorities": list(dict.fromkeys(loop["priority"] for loop in loops.values())),
            "plot": plot,
        }


def rows(loops: Mapping[str, Mapping[str, Any]]) -> list[dict[str, Any]]:
    """A row for each trial: cycles, skipped ones, and lateness [µs]."""
    late = [
        column([loop[f"lateness_{name}_us"] for loop in loops.values()])
        for name in ("p50", "p99", "max")
    ]
    return [
        {
            "trial": trial,
            "cells": [
                fixed(loop["cycles"], 0),
                fixed(loop["skipped"], 0),
                *(texts[k] for texts in late),
            ],
        }
        for k, (trial, loop) in enumerate(loops.items())
    ]


def histogram(loops: Mapping[str, Mapping[str, Any]]) -> go.Figure:
    """Share of all cycles in each bin of lateness; the last is open."""
    edges = next(iter(loops.values()))["edges"]
    alike = [loop["counts"] for loop in loops.values() if loop["edges"] == edges]
    counts = [sum(column) for column in zip(*alike, strict=True)]
    total = max(sum(counts), 1)
    labels = [f"{low:g} to {high:g} µs" for low, high in pairwise(edges)]
    labels.append(f"above {edges[-1]:g} µs")
    figure = bars(110 + 26 * len(labels), bargap=0.15)
    figure.add_bar(
        x=[100 * count / total for count in counts],
        y=labels,
        orientation="h",
        marker={"color": NAMED},
        text=[str(count) if count else "" for count in counts],
        textposition="outside",
        cliponaxis=False,
        showlegend=False,
        hovertemplate="%{x:.3g} % of the cycles<extra>%{y}</extra>",
    )
    most = 100 * max(counts, default=0) / total
    figure.update_xaxes(
        title_text="share of the cycles [%], their number beside", range=[0, 1.25 * most]
    )
    return figure
