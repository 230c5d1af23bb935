"""The table of the ladder: each model's scores on each set of trials, with intervals."""

import math
from collections.abc import Sequence
from typing import Any

from spirob.report.ladder_figure import interval
from spirob.report.numbers import column, fixed, is_number, percent

SPLITS = {"train": "training", "validate": "validation", "heldout": "held-out"}
NONE = ("", "")
MOST = 6  # decimals of R²


def rows(ladder: Sequence[dict[str, Any]], noise_floor: float | None) -> list[dict[str, Any]]:
    """One row for each model and set of trials: a cell is a score and its interval.

    fresh  the first row of a model, which has its name;  span  rows of that model
    """
    kept = [(rung, [s for s in SPLITS if rung.get(s)] or ["heldout"]) for rung in ladder]
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
                "trials": SPLITS[split],
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
    ends = [interval(rung, split, name) for rung, split in every]
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
