"""The base model's identified numbers: value, interval, and where they stand in their bounds."""

import math
from typing import Any

from spirob.report.data import ReportData
from spirob.report.sections import Section
from spirob.report.words import (
    fixed,
    given,
    interval,
    is_number,
    null_space,
    number,
    pairs,
    shown,
    spoken,
    unit_text,
)

WIDE = 50.0  # bounds further apart than this factor are drawn on a logarithmic scale


class Parameters(Section):
    """One row for each identified parameter."""

    order = 50
    title = "Parameters"
    template = "parameters.html.j2"
    pages = ("arm", "rig")

    def get_context(self, data: ReportData) -> dict[str, Any]:
        found = data.identified["parameters"]
        resolution = data.identified.get("resolution")
        left = (data.identified.get("train") or {}).get("rmse")
        return {
            "rows": [row(name, parameter) for name, parameter in found.items()],
            "at_bound": [spoken(name) for name, p in found.items() if p.get("at_bound")],
            "identifiability": data.identified.get("identifiability", ""),
            "train": train_sentence(data.identified.get("train")),
            "pairs": pairs(resolution) if resolution else [],
            "null_space": [null_space(resolution, left)] if resolution else [],
            "correlation": correlation(resolution) if resolution else [],
        }


def train_sentence(train: dict[str, Any] | None) -> str:
    """How well the base model fits the trials it was identified on."""
    if not train:
        return ""
    unit, factor = shown(train.get("unit", "A"))
    mae, rmse = (number(factor * train[key]) for key in ("mae", "rmse"))
    return (
        f"On the training trials the identified model leaves an MAE of {mae} {unit} and an RMSE "
        f"of {rmse} {unit} (R² {number(train.get('r2'))})."
    )


def correlation(resolution: dict[str, Any]) -> list[dict[str, Any]]:
    """The lower half of the matrix: a row for each number, text and strength of each cell."""
    names, table = resolution["names"], resolution["correlation"]
    return [
        {
            "name": spoken(name),
            "cells": [
                {"text": fixed(value, 2), "share": round(100 * abs(value)), "sign": value >= 0}
                for value in table[k][:k]
            ],
        }
        for k, name in enumerate(names)
    ]


def row(name: str, parameter: dict[str, Any]) -> dict[str, Any]:
    """Texts of one parameter and the positions, 0 to 100, of its marks between the bounds."""
    low, high = parameter.get("low"), parameter.get("high")
    value, span = interval(parameter["value"], low, high)
    bounds = parameter.get("bound_low"), parameter.get("bound_high")
    place = {
        key: position(parameter.get(key), *bounds) for key in ("value", "low", "high", "nominal")
    }
    return {
        "name": spoken(name),
        "meaning": parameter.get("meaning", ""),
        "unit": unit_text(parameter["unit"]),
        "value": value,
        "interval": span,
        "nominal": given(parameter.get("nominal")),
        "bounds": [given(bound) for bound in bounds],
        "at_bound": bool(parameter.get("at_bound")),
        "place": place if place["value"] is not None else None,
    }


def position(value: Any, low: Any, high: Any) -> float | None:
    """Where `value` stands between the bounds, in per cent; logarithmic where they are far."""
    if not all(is_number(v) for v in (value, low, high)) or high <= low:
        return None
    value = min(max(value, low), high)
    if low > 0 and high / low > WIDE:
        value, low, high = math.log(value), math.log(low), math.log(high)
    return round(100 * (value - low) / (high - low), 2)
