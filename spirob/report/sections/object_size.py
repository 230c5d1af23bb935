"""How well the size of a grasped cylinder is read from motor signals."""

from typing import Any

from spirob.report import figures
from spirob.report.data import ReportData
from spirob.report.numbers import fixed
from spirob.report.sections.section import Section

PAPER = {"simulation": {"mae": 1.12, "r2": 0.98}, "robot": {"mae": 3.95, "r2": 0.76}}
DOMAINS = {"simulation": "Simulation", "robot": "Robot"}
COLUMNS = (("mae", 2), ("rmse", 2), ("std", 2), ("r2", 3))


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
            plot = figures.Plot(
                "size", "Predicted over true diameter of the cylinder", figures.size(points)
            )
        metrics = data.metrics.get("size")
        reason = data.absent.get("size_metrics") or data.absent.get("predictions", "")
        return {"plot": plot, "rows": rows(metrics) if metrics else [], "reason": reason}


def rows(metrics: dict[str, Any]) -> list[dict[str, Any]]:
    """For each domain our figures [mm] and, under them, the paper's."""
    found = []
    for domain, title in DOMAINS.items():
        for source, numbers in (("here", metrics.get(domain) or {}), ("paper", PAPER[domain])):
            cells = [_cell(numbers, key, decimals, source) for key, decimals in COLUMNS]
            found.append({"domain": title, "source": source, "cells": cells})
    return found


def _cell(numbers: dict[str, Any], key: str, decimals: int, source: str) -> str:
    return fixed(numbers.get(key), 2 if source == "paper" else decimals)
