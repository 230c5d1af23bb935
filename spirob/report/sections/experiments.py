"""The paper's experiments: robot, model and baseline, beside the paper's figures."""

from typing import Any

from spirob.report.data import ReportData
from spirob.report.experiment_figures import overlays
from spirob.report.sections.section import Section
from spirob.report.words import MISSING, is_number, number, unit_text

SIDES = ("robot", "base", "named", "single")
MET = {True: "met", False: "missed", None: ""}


class Experiments(Section):
    """One table and its overlays for each experiment."""

    order = 55
    title = "The paper's experiments"
    template = "experiments.html.j2"

    def get_context(self, data: ReportData) -> dict[str, Any]:
        if data.experiments is None:
            return {"experiments": [], "met": 0, "aims": 0, "reason": data.absent["experiments"]}
        found = [_experiment(name, one) for name, one in data.experiments.items()]
        rows = [row for one in data.experiments.values() for row in one["rows"]]
        aims = [row["met"] for row in rows if row["met"] is not None]
        return {"experiments": found, "met": sum(aims), "aims": len(aims), "reason": ""}


def _experiment(name: str, one: dict[str, Any]) -> dict[str, Any]:
    first = [r for r in one["rows"] if r["aim"] or r["paper"] is not None]
    return {
        "title": one["title"],
        "about": one.get("about", ""),
        "rows": [_row(r) for r in first],
        "others": [_row(r) for r in one["rows"] if r not in first],
        "plots": overlays(name, one["curves"]),
    }


def _row(row: dict[str, Any]) -> dict[str, Any]:
    notes = [row["note"], f"aim: {row['aim']}" if row["aim"] else ""]
    return {
        "what": row["what"],
        "unit": unit_text(row["unit"]),
        "cells": [_cell(row[side]) for side in SIDES],
        "paper": _cell(row["paper"]),
        "verdict": MET[row["met"]],
        "note": "; ".join(note for note in notes if note),
    }


def _cell(value: Any) -> str:
    if isinstance(value, str):
        return value
    return number(value) if is_number(value) else MISSING
